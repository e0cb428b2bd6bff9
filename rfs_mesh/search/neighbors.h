/// The k nearest and the radius neighbours of points in space, exact, ties by index.
///
/// Why an index of our own and not FLANN: the EMST needs a search that skips subtrees of its own component,
/// equal distances must come in the order of the indices (determinism), and filling the table of all points
/// leaf by leaf (leaf_neighbors.h) is faster. Times at 1,000,000 noisy surface points in Morton order, one
/// thread, medians of one interleaved run of tests/bench/rfs_mesh/emst_bench.cpp:
///
///                             build   k = 8   k = 32
///     this over FLANN         1.07    0.26    0.24
///     this over nanoflann     1.61    0.32    0.22
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "base/unfilled.h"
#include "rfs_mesh/points.h"
#include "rfs_mesh/search/kd_tree.h"

namespace rfsmooth::rfs_mesh {

/// A point and its squared distance.
struct Neighbor {
  Index index;
  double squared_distance;
  /// The order of every list: by distance, ties by index.
  friend bool operator<(const Neighbor& a, const Neighbor& b) {
    return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance
                                                    : a.index < b.index;
  }
  friend bool operator==(const Neighbor& a, const Neighbor& b) {
    return a.squared_distance == b.squared_distance && a.index == b.index;
  }
};

/// Sorts by (distance, index). Squared distances of points on a surface are spread evenly, so most points
/// find their place by their distance alone. O(n) for these, O(n log n) for all others.
void sort_neighbors(std::vector<Neighbor>& list);

/// The k nearest of every point: n x k.
struct NeighborTable {
  int k = 0;                                  ///< as asked for, but at most n - 1: every row is full
  std::vector<Index, Unfilled<Index>> items;  ///< row i: ascending by (distance, index), without i itself

  std::size_t size() const { return k == 0 ? 0 : items.size() / std::size_t(k); }
  Adjacency::Row operator[](std::size_t i) const {
    const Index* const first = items.data() + i * std::size_t(k);
    return {first, first + k};
  }
};

/// A kd-tree over points that do not move. They may be in any order and may coincide; searches are fastest
/// along a Morton curve, as in the working cloud. O(n log n) to build, O(log n + k) a query. Thread safe once
/// built.
class SpatialIndex {
 public:
  /// Keeps a reference to `points` (n x 3, finite), which must outlive the index and not change.
  SpatialIndex(const Positions& points, const Context& context);

  /// Reuses `tree`, built over the same points at other places near these. This saves most of the time.
  SpatialIndex(const Positions& points, KdTree tree, const Context& context);

  const Positions& points() const { return points_; }
  const KdTree& tree() const { return tree_; }

  /// The k nearest other points of every point (a coincident one counts, at distance 0). Parallel.
  NeighborTable nearest(int k, const Context& context) const;

  /// Searches the rows of the points flagged in `wanted` (n) again. `table`: from nearest().
  void renew(NeighborTable& table, const std::vector<char>& wanted, const Context& context) const;

  /// The k nearest points of any query (all if there are fewer), ascending by (distance, index). A point of
  /// the cloud at the query is included. Replaces `out`.
  void nearest(const Eigen::Vector3d& query, int k, std::vector<Neighbor>& out) const;

  /// The same of the points with |point - query|^2 <= bound.
  void nearest_within(const Eigen::Vector3d& query, int k, double bound, std::vector<Neighbor>& out) const;

  /// All points with |point - query| <= radius, ascending by (distance, index). Replaces `out`.
  void within(const Eigen::Vector3d& query, double radius, std::vector<Neighbor>& out) const;

  /// The same points as they come, which is faster: an order that depends on where all points are.
  void within_unsorted(const Eigen::Vector3d& query, double radius, std::vector<Neighbor>& out) const;

  /// Whether a point is within `radius`. O(log n), fastest if there is none.
  bool any_within(const Eigen::Vector3d& query, double radius) const;

  /// The same index without the points flagged in `gone` (n): they are not found any more. Of its searches,
  /// nearest_within(), within() and any_within() are for use. O(n), parallel.
  SpatialIndex without(const std::vector<char>& gone, const Context& context) const;

  /// Gives up the tree, for an index of the same points elsewhere. The index cannot be searched afterwards.
  KdTree release_tree() { return std::move(tree_); }

 private:
  SpatialIndex(const Positions& points, KdTree tree) : points_(points), tree_(std::move(tree)) {}
  void fill(NeighborTable& table, const std::vector<char>* wanted, const Context& context) const;

  const Positions& points_;
  KdTree tree_;
};

/// The nearest point of `index`, which has one, to each of n places. O(n log n), parallel.
std::vector<Index> nearest_points(const SpatialIndex& index, const Positions& places, const Context& context);

/// The table of a cloud without the points flagged in `gone` (n), equal to left.nearest(near.k); only rows
/// that held one of them are searched again. `near`: of the whole cloud; `left`: of the remaining points, in
/// their order. Parallel.
NeighborTable nearest_left(const NeighborTable& near, const std::vector<char>& gone, const SpatialIndex& left,
                           const Context& context);

}  // namespace rfsmooth::rfs_mesh
