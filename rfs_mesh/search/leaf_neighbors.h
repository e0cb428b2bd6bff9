/// The k nearest of all points of one leaf of the kd-tree at once: how SpatialIndex fills its table.
///
/// The eight points share one walk through the tree. How far to look is guessed from the k-th neighbour of
/// the point before, which is near. The points of the leaves listed are turned into single precision around
/// the leaf, and what is within the guess is kept and ranked by counting the nearer ones of each: no heap, no
/// comparison that the processor would have to foresee. Where k are within the guess, the k nearest are among
/// them; where not, the point is given a second look as far as the walk went, and failing that a search of
/// its own. Where two are as far up to what single precision can tell, the distances are taken in double
/// precision. So a bad guess or rounding costs time, never exactness.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rfs_mesh/search/kd_tree.h"

namespace rfsmooth::rfs_mesh {

/// Scratch of one thread; reused from leaf to leaf.
class LeafNeighbors {
 public:
  /// k < number of points.
  LeafNeighbors(const KdTree& tree, std::size_t k);

  /// A squared distance to expect a k-th neighbour at; to be told after a search of its own.
  void expect(double squared_distance) { guess_ = squared_distance; }

  /// Prepares the leaf. False: too many leaves are near, search its points one by one.
  bool prepare(std::uint32_t leaf);

  /// The k nearest of the leaf's point `slot` other than itself into row[0, k), ascending by (distance,
  /// index). False: not found within the bound, search it by itself.
  bool find(std::uint32_t slot, Index* row);

 private:
  void list_leaves(const KdTree::Node& box, double squared_bound);
  bool find_within(std::uint32_t slot, double share);
  bool rank();
  void rank_exactly(std::uint32_t slot);
  void load_listed(const KdTree::Node& box);
  double squared_distance_to(std::uint32_t slot, std::uint32_t place) const;
  Index id_at(std::uint32_t place) const;
  Eigen::Vector3d point(std::uint32_t slot) const { return {leaf_->x[slot], leaf_->y[slot], leaf_->z[slot]}; }

  const KdTree& tree_;
  std::size_t k_;
  double widen_ = 1, widen_list_ = 1;  // of the guess: for a point, for its leaf (squared)
  double guess_ = 0;                   // squared distance of the last point's k-th neighbour

  const KdTree::Leaf* leaf_ = nullptr;
  double list_bound_ = 0;            // squared; leaves farther from the leaf's box are not listed
  std::vector<std::uint32_t> list_;  // leaves
  // The points of the listed leaves: from the middle of the leaf's box, in units of the bound.
  std::vector<float> x_, y_, z_, key_;
  std::array<float, KdTree::kLeaf> own_x_, own_y_, own_z_;  // those of the leaf
  float uncertain_ = 0;                                     // what rounding may do to a squared distance

  std::vector<std::uint16_t> kept_;   // places in x_
  std::vector<float> kept_key_;       // squared distances of the kept
  std::vector<std::uint32_t> place_;  // of rank 0, 1, ... (0 is the point itself): its place in x_
  std::vector<float> sorted_;         // keys by rank
  std::vector<std::uint32_t> nearer_;
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
