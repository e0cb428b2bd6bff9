/// Searches of the kd-tree for points of other components than one's own. Internal to Boruvka's algorithm
/// (emst.h).
///
/// `label` stores for each node the component that all its points share, if they do. Searches skip subtrees
/// inside the own component. Ties go by index.
#pragma once

#include <limits>
#include <vector>

#include "base/parallel.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Searches for foreign points: those of another component. Const functions may run in parallel.
class ForeignSearch {
 public:
  using Cursor = KdTree::Cursor;

  /// A few leaves.
  struct Leaves {
    static constexpr std::size_t kMost = 64;
    Cursor at[kMost];
    std::size_t count = 0;
  };

  /// \param component n: of each of the index's points; read at every call, so it outlives this.
  ForeignSearch(const SpatialIndex& index, const std::vector<Index>& component)
      : points_(index.points()),
        tree_(index.tree()),
        component_(component),
        shared_(tree_.node_count()),
        subtrees_(tree_.subtrees(kSubtree)) {}

  /// Subtrees that cover the tree, each for one thread.
  const std::vector<Cursor>& subtrees() const { return subtrees_; }

  /// Updates the labels of the nodes from `component`. O(n), parallel.
  void label(const Context& context) {
    tree_.for_each_node_upward(context, [&](const Cursor& c) {
      shared_[c.node] =
          c.is_leaf() ? shared_by_leaf(c) : common(shared_[c.left().node], shared_[c.right().node]);
    });
  }

  /// The component that all points of a node share, kNone if they do not.
  Index shared(const Cursor& c) const { return shared_[c.node]; }

  /// Whether a leaf with foreign points is within sqrt(bound) of the box of `of`, whose points are all of
  /// `own`.
  bool any_within(const Cursor& of, Index own, double bound) const {
    bool any = false;
    visit(of, own, bound, [&](const Cursor&) {
      any = true;
      return false;
    });
    return any;
  }

  /// Lists these leaves. False if there are more than Leaves::kMost, or `bound` is infinite.
  bool list(const Cursor& of, Index own, double bound, Leaves& leaves) const {
    if (bound == std::numeric_limits<double>::infinity()) return false;
    leaves.count = 0;
    bool fits = true;
    visit(of, own, bound, [&](const Cursor& leaf) {
      fits = leaves.count < Leaves::kMost;
      if (fits) leaves.at[leaves.count++] = leaf;
      return fits;
    });
    return fits;
  }

  /// The foreign point in `leaves` nearest to the point `self` and at most sqrt(bound) away, or {kNone,
  /// bound}.
  Neighbor nearest_in(const Leaves& leaves, Index self, Index own, double bound) const {
    const Eigen::Vector3d q = points_[self];
    Neighbor best = {kNone, bound};
    for (std::size_t l = 0; l < leaves.count; ++l)
      if (squared_distance(q, tree_.node(leaves.at[l].node)) <= best.squared_distance)
        scan(leaves.at[l], q, own, best);
    return best;
  }

  /// The nearest foreign point in the whole tree, as `nearest_in`.
  Neighbor nearest(Index self, Index own, double bound) const {
    const Eigen::Vector3d q = points_[self];
    Neighbor best = {kNone, bound};
    struct Pending {
      Cursor cursor;
      double squared_distance;
    } stack[KdTree::kMostPending];
    std::size_t top = 0;
    stack[top++] = {tree_.root(), 0};
    while (top > 0) {
      Pending at = stack[--top];
      while (shared_[at.cursor.node] != own &&
             !(best < Neighbor{tree_.node(at.cursor.node).least_id, at.squared_distance})) {
        if (at.cursor.is_leaf()) {
          scan(at.cursor, q, own, best);
          break;
        }
        Pending near = {at.cursor.left(), 0}, far = {at.cursor.right(), 0};
        near.squared_distance = squared_distance(q, tree_.node(near.cursor.node));
        far.squared_distance = squared_distance(q, tree_.node(far.cursor.node));
        if (far.squared_distance < near.squared_distance) std::swap(near, far);
        stack[top++] = far;
        at = near;
      }
    }
    return best;
  }

 private:
  static constexpr std::uint32_t kSubtree = 128;  ///< leaves

  /// What two parts of a node share.
  static Index common(Index one, Index other) { return one == other ? one : kNone; }

  Index shared_by_leaf(const Cursor& c) const {
    const KdTree::Leaf& leaf = tree_.leaf(c.first);
    Index shared = component_[leaf.id[0]];
    for (std::uint32_t i = 1; i < KdTree::kLeaf && leaf.id[i] != kNone; ++i)
      shared = common(shared, component_[leaf.id[i]]);
    return shared;
  }

  /// Calls `see(cursor)` for the leaves with foreign points whose boxes are within sqrt(bound) of that of
  /// `of`, until it returns false.
  template <class See>
  void visit(const Cursor& of, Index own, double bound, See&& see) const {
    const KdTree::Node& box = tree_.node(of.node);
    tree_.for_each_leaf(
        [&](const Cursor& at) {
          return shared_[at.node] != own && squared_distance(box, tree_.node(at.node)) <= bound;
        },
        see);
  }

  void scan(const Cursor& c, const Eigen::Vector3d& q, Index own, Neighbor& best) const {
    const KdTree::Leaf& leaf = tree_.leaf(c.first);
    for (std::uint32_t i = 0; i < KdTree::kLeaf; ++i) {
      const Neighbor candidate = {leaf.id[i], squared_distance(q, leaf.point(i))};
      if (candidate < best && component_[leaf.id[i]] != own) best = candidate;
    }
  }

  const Positions& points_;
  const KdTree& tree_;
  const std::vector<Index>& component_;
  std::vector<Index> shared_;  ///< of each node
  std::vector<Cursor> subtrees_;
};

}  // namespace rfsmooth::rfs_mesh
