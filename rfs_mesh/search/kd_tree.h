/// The kd-tree under SpatialIndex: leaves of eight points, tight boxes, no pointers.
///
/// The points are split at medians of the widest axis (halving.h) into leaves of exactly kLeaf points; the
/// last may be short. Nodes are stored in preorder, and the number of leaves determines their layout: the
/// node over the leaves [first, last) has its left child right behind it and its right child behind the left
/// subtree. A leaf stores its coordinates by axis, so that a scan of it is a few SIMD instructions.
///
/// Exactness: squared distances to points and to boxes are both computed as (dx^2 + dy^2) + dz^2 without
/// fused multiply-add. Rounding is monotone, so the distance to a box never exceeds that to a point in it.
///
/// O(n log n) to build, in parallel; the same tree for any number of threads. 43 bytes a point. Read-only
/// once built: any number of threads may search it.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <rfsmooth/context.h>

#include "base/parallel.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::rfs_mesh {

/// A balanced tree over points in leaves of eight.
class KdTree {
 public:
  static constexpr std::uint32_t kLeaf = 8;            ///< points in a leaf
  static constexpr std::uint32_t kSerialLeaves = 512;  ///< of subtrees that are for one thread, in its cache

  /// Coordinates by axis; the missing points of a short leaf lie at infinity, behind the others, and have the
  /// id kNone.
  struct Leaf {
    double x[kLeaf], y[kLeaf], z[kLeaf];
    Index id[kLeaf];
    Eigen::Vector3d point(std::size_t i) const { return {x[i], y[i], z[i]}; }
    void put(std::size_t i, const Eigen::Vector3d& p, Index of) {
      x[i] = p[0];
      y[i] = p[1];
      z[i] = p[2];
      id[i] = of;
    }
    /// Leaves the places from i on without points.
    void end_at(std::size_t i) {
      for (; i < kLeaf; ++i)
        put(i, Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), kNone);
    }
  };

  /// A summary of the points below a node.
  struct Node {
    Eigen::Vector3d low, high;  ///< tight box
    Index least_id;             ///< smallest id in the node: breaks ties of distance
    void extend(const Eigen::Vector3d& p) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  };

  /// A node and the leaves [first, last) that it covers.
  struct Cursor {
    std::uint32_t node, first, last;
    bool is_leaf() const { return last - first == 1; }
    std::uint32_t middle() const { return first + (last - first) / 2; }
    Cursor left() const { return {node + 1, first, middle()}; }
    Cursor right() const { return {node + 2 * (middle() - first), middle(), last}; }
  };

  /// \throw std::invalid_argument if a coordinate is not finite or squares of lengths overflow.
  KdTree(const Positions& points, const Context& context);

  /// The tree whose order() that is, without places: to be searched after follow(). O(n).
  explicit KdTree(const std::vector<Index>& order);

  /// The ids leaf by leaf: all that cannot be made again from the points, in a tenth of the memory. Of trees
  /// that nothing was left out of. O(n).
  std::vector<Index> order() const;

  /// Moves the points to other places (finite, as above). The leaves keep their points; the boxes are made
  /// tight again. Searches stay exact, and as fast as in a new tree if neighbours stayed neighbours. O(n),
  /// parallel, a tenth of the time of a new tree.
  void follow(const Positions& points, const Context& context);

  /// Takes out the points flagged in `gone` (of all that the tree was built over); the boxes are made tight
  /// again. The layout stays, so a search is as fast as in a new tree if not most of them go. O(n), parallel.
  void leave_out(const std::vector<char>& gone, const Context& context);

  bool empty() const { return leaves_.empty(); }
  Cursor root() const { return {0, 0, std::uint32_t(leaves_.size())}; }
  const Node& node(std::uint32_t i) const { return nodes_[i]; }
  const Leaf& leaf(std::uint32_t i) const { return leaves_[i]; }
  std::size_t node_count() const { return nodes_.size(); }
  std::size_t leaf_count() const { return leaves_.size(); }

  /// Nodes that a walk from the root may have to come back to: 2^32 points make 29 levels, one node each.
  static constexpr std::size_t kMostPending = 64;

  /// Calls `see(leaf's cursor)` from left to right, until it returns false, for the leaves all of whose nodes
  /// from the root down `enter(cursor)` lets in.
  template <class Enter, class See>
  void for_each_leaf(Enter&& enter, See&& see) const {
    if (empty()) return;
    Cursor stack[kMostPending];
    std::size_t top = 0;
    stack[top++] = root();
    while (top > 0) {
      Cursor at = stack[--top];
      while (enter(at)) {
        if (at.is_leaf()) {
          if (!see(at)) return;
          break;
        }
        stack[top++] = at.right();
        at = at.left();
      }
    }
  }

  /// The largest subtrees of at most that many leaves, left to right: work for parallel loops.
  std::vector<Cursor> subtrees(std::uint32_t leaves) const;

  /// Calls `visit(cursor)` for every node, after those below it. Parallel.
  template <class Visit>
  void for_each_node_upward(const Context& context, Visit&& visit) const {
    const std::vector<Cursor> small = subtrees(kSerialLeaves);
    for_each_index(
        context, small.size(), [&](std::size_t s) { upward(small[s], 0, visit); }, 1);
    if (!empty()) upward(root(), kSerialLeaves, visit);
  }

 private:
  /// A node and all below it, of those of more than `done` leaves.
  template <class Visit>
  static void upward(const Cursor& c, std::uint32_t done, Visit& visit) {
    if (c.last - c.first <= done) return;
    if (!c.is_leaf()) {
      upward(c.left(), done, visit);
      upward(c.right(), done, visit);
    }
    visit(c);
  }
  template <class Enclose>
  void enclose_all(const Context& context, const Enclose& enclose_leaf);

  std::vector<Node> nodes_;   // preorder
  std::vector<Leaf> leaves_;  // left to right
};

/// Squared length as the tree evaluates it (bit for bit).
inline double squared_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  const double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
  return (x * x + y * y) + z * z;
}

/// 2 max(x, 0), without a branch: along a walk through the tree it would be unpredictable.
inline double twice_positive(double x) {
  return x + std::abs(x);
}

/// Squared distance between two boxes, 0 if they meet.
inline double squared_distance(const KdTree::Node& a, const KdTree::Node& b) {
  double d[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double below = a.low[axis] - b.high[axis], above = b.low[axis] - a.high[axis];
    d[axis] = twice_positive(below > above ? below : above);
  }
  return 0.25 * ((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);  // powers of two: the same bits
}

/// Squared distance from a point to a box, 0 inside.
inline double squared_distance(const Eigen::Vector3d& q, const KdTree::Node& box) {
  double d[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double below = box.low[axis] - q[axis], above = q[axis] - box.high[axis];
    d[axis] = twice_positive(below > above ? below : above);
  }
  return 0.25 * ((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);
}

}  // namespace rfsmooth::rfs_mesh
