/// Exact distances to a triangle mesh and to a cloud, as `compare` measures them.
///
/// Both use one tree of axis-aligned boxes, of which the nearer half is searched first, and are exact up to
/// rounding. (The trees of rfs_mesh/search hold points only, and know no distance from a triangle.) The sign
/// of a distance comes from angle-weighted pseudo-normals (Baerentzen & Aanaes 2005, "Signed distance
/// computation using the angle weighted pseudonormal"), which are right at edges and corners too. O(n log n)
/// to build, typically O(log n) a query. Queries are const and may run in parallel.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <rfsmooth/mesh.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::pipeline {

/// An axis-aligned box.
using Box = Eigen::AlignedBox3d;
/// A triangle, by its corners.
using Triangle = std::array<Eigen::Vector3d, 3>;

/// Boxes of items, halved along the longest axis. The same tree for the same items, whatever the machine.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(const std::vector<Box>& items);

  /// Calls `visit(item)` for every item that may be nearer than `best` (a squared distance that `visit`
  /// lowers). `bound(box)` must not exceed the squared distance to anything inside the box. Items at exactly
  /// `best` are visited too, so that `visit` can decide ties by index.
  template <class Bound, class Visit>
  void search(Bound&& bound, Visit&& visit, double& best) const;

 private:
  struct Node {
    Box box;
    Index first = 0;  ///< leaf: its first item in order_; inner: its left child (the right one is next to it)
    Index count = 0;  ///< items of a leaf, 0 for an inner node
  };
  void split(std::size_t node, std::size_t first, std::size_t last, const std::vector<Box>& items);
  std::vector<Node> nodes_;
  std::vector<Index> order_;
};

/// Finds the nearest point of a cloud.
class PointTree {
 public:
  /// What was found nearest.
  struct Hit {
    Index point = kNone;
    double squared = 0;
  };
  explicit PointTree(Positions points);
  const Positions& points() const { return points_; }

  /// The nearest point other than `skip`, ties by index. `point` is kNone if there is none.
  Hit nearest(const Eigen::Vector3d& query, Index skip = kNone) const;

  /// Squared distance from a triangle (filled) to the nearest point.
  double squared_distance_from(const Triangle& triangle) const;

 private:
  Positions points_;
  BoxTree tree_;
};

/// A point of a triangle. `feature`: 0 in its inside; 1, 2, 3 on the edge opposite corner 0, 1, 2; 4, 5, 6 at
/// corner 0, 1, 2.
struct TrianglePoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  int feature = 0;
};
/// The point of the triangle nearest to `query`. A degenerate triangle is its longest edge, or a point.
TrianglePoint nearest_on_triangle(const Eigen::Vector3d& query, const Triangle& triangle);

/// A triangle mesh to measure against. Corners at bit-equal positions count as one vertex, so an unindexed
/// soup works.
class TrueSurface {
 public:
  /// What was found nearest.
  struct Hit {
    Index face = kNone;
    double squared = 0;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    int feature = 0;  ///< as in TrianglePoint
  };

  /// \throw std::invalid_argument if there is no face, or a face names a vertex that does not exist.
  TrueSurface(Positions vertices, std::vector<Face> faces);

  Hit nearest(const Eigen::Vector3d& query) const;

  /// The signed distance. For a closed surface negative inside, whatever the orientation of its faces; for an
  /// open one negative on the side that its normals point away from.
  double signed_distance(const Eigen::Vector3d& query) const {
    return signed_distance(query, nearest(query));
  }
  double signed_distance(const Eigen::Vector3d& query, const Hit& hit) const;  ///< `hit` = nearest(query)

  std::size_t face_count() const { return faces_.size(); }
  Triangle corners(std::size_t face) const;
  /// Unit length; zero for a degenerate face. Points out of a closed surface whatever the orientation of its
  /// faces.
  Eigen::Vector3d outward_normal(std::size_t face) const { return side_ * face_normal(face); }

  /// Every edge has two faces that run along it in opposite directions.
  bool closed() const { return closed_; }
  double area() const { return area_; }
  double volume() const { return volume_; }  ///< of a closed surface, positive; 0 for an open one

 private:
  Eigen::Vector3d face_normal(std::size_t face) const;
  void weld();
  void make_pseudo_normals();
  Positions vertices_;
  std::vector<Face> faces_;
  std::vector<Eigen::Vector3d> vertex_normals_;
  std::vector<std::array<Eigen::Vector3d, 3>> edge_normals_;  ///< per face: of the edge opposite of corner k
  BoxTree tree_;
  bool closed_ = false;
  double area_ = 0, volume_ = 0, side_ = 1;  ///< side_: -1 where the faces of a closed surface look inward
};

template <class Bound, class Visit>
void BoxTree::search(Bound&& bound, Visit&& visit, double& best) const {
  if (nodes_.empty()) return;
  struct Entry {
    Index node;
    double bound;
  };
  std::array<Entry, 128> stack;  // two per level; halving keeps the depth below 64
  std::size_t size = 0;
  stack[size++] = {0, bound(nodes_[0].box)};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.bound > best) continue;
    const Node& node = nodes_[entry.node];
    if (node.count > 0) {
      for (Index k = node.first; k < node.first + node.count; ++k) visit(order_[k]);
      continue;
    }
    Entry near{node.first, bound(nodes_[node.first].box)};
    Entry far{node.first + 1, bound(nodes_[node.first + 1].box)};
    if (far.bound < near.bound) std::swap(near, far);
    stack[size++] = far;
    stack[size++] = near;
  }
}

}  // namespace rfsmooth::pipeline
