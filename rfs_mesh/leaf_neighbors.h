/// The k nearest of all points of one leaf of the kd-tree at once: how SpatialIndex fills its table.
///
/// The eight points share one walk through the tree. How far to look is guessed from the k-th neighbour of
/// the point before, which is near, and checked by counting: if k points lie within the guess, the k nearest
/// are among them; if not, the point is given a second look as far as the walk went, and failing that a
/// search of its own. So a bad guess costs time, never exactness. A point scans the listed leaves that its
/// bound reaches, keeps what lies within without a branch, and ranks the few kept by counting the nearer ones
/// of each: no heap, no comparison that the processor would have to foresee.
#pragma once

#include <vector>

#include "rfsmooth/rfs_mesh/kd_tree.h"

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
  void keep_within(const Eigen::Vector3d& q, Index self, double squared_bound);
  bool rank(double squared_bound);
  void sort();
  Eigen::Vector3d point(std::uint32_t slot) const { return {leaf_->x[slot], leaf_->y[slot], leaf_->z[slot]}; }

  const KdTree& tree_;
  std::size_t k_;
  double widen_ = 1, widen_list_ = 1;  // of the guess: for a point, for its leaf (squared)
  double guess_ = 0;                   // squared distance of the last point's k-th neighbour

  const KdTree::Leaf* leaf_ = nullptr;
  double list_bound_ = 0;            // squared; leaves farther from the leaf's box are not listed
  std::vector<std::uint32_t> list_;  // leaves
  std::vector<KdTree::Node> boxes_;  // of the listed leaves
  std::vector<std::uint32_t> near_;  // of the listed leaves: those within one point's bound
  std::vector<double> distance_;     // squared, of the points kept for it
  std::vector<Index> id_;
  std::vector<std::uint32_t> place_;  // of rank 0, 1, ...: where it is in distance_ and id_
  std::vector<float> key_;
  std::size_t kept_ = 0;
};

}  // namespace rfsmooth::rfs_mesh
