/// The k nearest neighbours of all points of one kd-tree leaf at once; SpatialIndex fills its table with it.
///
/// The eight points share one walk through the tree. The search radius is guessed from the distance of the
/// previous point's k-th neighbour, since that point is near. The points of the leaves found are converted to
/// single precision around the leaf; those within the guess are kept and ranked by counting, for each, the
/// points nearer than it. This needs no heap and has no unpredictable branch.
///
/// If k points are within the guess, the k nearest are among them. If not, the point is searched again as far
/// as the walk went, and failing that in the whole tree. Where two distances are equal up to single-precision
/// rounding, they are computed in double precision. So a bad guess or rounding costs time, never exactness.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rfs_mesh/search/kd_tree.h"

namespace rfsmooth::rfs_mesh {

/// The search, with its scratch memory, reused from leaf to leaf. One object per thread.
class LeafNeighbors {
 public:
  /// k < number of points.
  LeafNeighbors(const KdTree& tree, std::size_t k);

  /// Sets the squared distance at which to expect the next k-th neighbour. Call it after a point was searched
  /// in the whole tree.
  void expect(double squared_distance) { guess_ = squared_distance; }

  /// Prepares the leaf. False if too many leaves are near: search its points one by one.
  bool prepare(std::uint32_t leaf);

  /// Writes the k nearest of the leaf's point `slot`, without itself, to row[0, k), ascending by (distance,
  /// index). False if there are not k within the bound: search the whole tree for it.
  bool find(std::uint32_t slot, Index* row);

 private:
  void list_leaves(const KdTree::Node& box, double squared_bound);
  bool find_within(std::uint32_t slot, double share);
  void drop_farther();
  bool rank();
  void rank_equal();
  void tell_apart(std::uint32_t slot);
  void load_listed(const KdTree::Node& box);
  double squared_distance_to(std::uint32_t slot, std::uint32_t place) const;
  Index id_at(std::uint32_t place) const;

  const KdTree& tree_;
  std::size_t k_;
  double widen_ = 1, widen_list_ = 1;  // factors on the guess, for a point and its leaf (squared)
  double guess_ = 0;                   // squared distance of the last point's k-th neighbour

  const KdTree::Leaf* leaf_ = nullptr;
  double list_bound_ = 0;            // squared; leaves farther from the leaf's box are not listed
  std::vector<std::uint32_t> list_;  // leaves
  // The points of the listed leaves: from the middle of the leaf's box, in units of the bound.
  std::vector<float> x_, y_, z_, key_;
  std::array<float, KdTree::kLeaf> own_x_, own_y_, own_z_;  // those of the leaf
  float uncertain_ = 0;                                     // largest rounding error of a squared distance

  std::vector<std::uint16_t> kept_;   // places in x_, y_, z_
  std::vector<float> kept_key_;       // squared distances of the kept
  std::vector<std::uint32_t> place_;  // of rank 0, 1, ... (0 is the point itself): its place in x_
  std::vector<float> sorted_;         // keys by rank
  std::vector<std::uint32_t> nearer_;
  std::vector<std::uint32_t> taken_;  // of each rank: how many have it
  struct Exact {
    double squared_distance;
    Index id;
    std::uint32_t place;
    friend bool operator<(const Exact& a, const Exact& b) {
      return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance : a.id < b.id;
    }
  };
  std::vector<Exact> exact_;
  std::size_t kept_count_ = 0;
};

}  // namespace rfsmooth::rfs_mesh
