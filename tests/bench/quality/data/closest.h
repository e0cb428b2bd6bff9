/// Exact nearest primitives by a bounding-box tree: the truth's side of the quality benchmark, written apart
/// from the library's own search so that a mistake there cannot hide itself.
#pragma once

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/mesh.h>

namespace rfsmooth::bench {

/// A tree over triangles, or over points (triangles whose corners coincide). Holds copies; immutable, so
/// queries from several threads are safe. Build O(n log n), query about O(log n).
class ClosestTree {
 public:
  explicit ClosestTree(const Positions& points);
  explicit ClosestTree(const Mesh& mesh);

  struct Hit {
    double squared = std::numeric_limits<double>::infinity();
    Index primitive = kNone;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
  };

  /// The nearest primitive other than `except`; none (kNone) if the tree is empty.
  Hit nearest(const Eigen::Vector3d& query, Index except = kNone) const;

  /// The k nearest (squared distance, primitive), nearest first; fewer if there are fewer.
  std::vector<std::pair<double, Index>> k_nearest(const Eigen::Vector3d& query, std::size_t k) const;

 private:
  struct Triangle {
    Eigen::Vector3d a, b, c;
    Index id;
  };
  struct Node {
    Eigen::Vector3d low, high;
    Index first = 0, count = 0;  // leaf: triangles; inner node: left child = the next node
    Index right = 0;
  };

  void build(Index first, Index last);
  template <class Visit, class Bound>
  void search(const Eigen::Vector3d& query, Visit&& visit, Bound&& bound) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

/// The point of triangle abc nearest to p (Ericson, Real-Time Collision Detection, 5.1.5).
Eigen::Vector3d closest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace rfsmooth::bench
