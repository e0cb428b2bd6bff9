/// The surface of a smoothed cloud as each of its points sees it: a tangent plane with a quadric over it, to
/// move points along. Thread safe: no state is kept.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/levels.h"
#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/patches/fit/quadric_sums.h"

namespace rfsmooth::smoothing {

inline constexpr float kSameNormal = 0.85F;  ///< cosine: a neighbour beyond it means an edge
inline constexpr float kMostRise =
    0.3F;  ///< of the way along the surface: beyond it a quadric is no more trusted

/// A point's surface: x(u, v) = p + u t + v b + (c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2) n. In single
/// precision: it only gives moves, which are short.
struct TangentFrame {
  Eigen::Vector3f t, b, n;
  Eigen::Matrix<float, 5, 1> quadric;
  float distance;  ///< between points near here, as on a hexagonal grid; 0: no frame
  float reach;     ///< how far the quadric knows the surface: to the last of its points
  bool curved;     ///< whether the quadric is to be followed

  /// The part along the surface; 0 where there is none.
  Eigen::Vector2f offset(const Eigen::Vector3f& d) const {
    return distance > 0 ? Eigen::Vector2f(d.dot(t), d.dot(b)) : Eigen::Vector2f(0, 0);
  }
  /// p moved by m: over the quadric where there is one, but rising by no more than a share of the way.
  Eigen::Vector3d slide(const Eigen::Vector3d& p, const Eigen::Vector2f& m) const {
    if (!(distance > 0)) return p;
    const float u = m.x(), v = m.y(), most = kMostRise * m.norm();
    const float rise =
        curved ? u * (quadric[0] + u * quadric[2] + v * quadric[3]) + v * (quadric[1] + v * quadric[4]) : 0;
    return p + (u * t + v * b + std::clamp(rise, -most, most) * n).cast<double>();
  }
};

/// The kNeighbourhood nearest of a point in its frame, by axis, in units of the farthest.
struct TangentNeighbors {
  static_assert(rfs_mesh::kNeighbourhood % kLanes == 0);
  using Values = std::array<float, rfs_mesh::kNeighbourhood>;
  Values u, v, height, weight;
  Values cosine;  ///< between the normals
};

/// The kNeighbourhood nearest of every point, nearer ones first, and the normals of their planes.
class NearestRows {
 public:
  /// Picks them out of the rows of `table`, in place: n x 24 to 256 neighbours of every point where it was
  /// about as near to them as now, say on the guide. O(n), parallel, the same bits for any number of threads.
  /// \throw std::invalid_argument if there are fewer or more.
  NearestRows(rfs_mesh::NeighborTable table, const Positions& points, const Context& context);

  Adjacency::Row operator[](std::size_t i) const {
    const Index* const first = table_.items.data() + i * std::size_t(table_.k);
    return {first, first + rfs_mesh::kNeighbourhood};
  }
  const std::vector<Eigen::Vector3f>& normals() const { return normals_; }  ///< n, unit
  void drop_normals() { std::vector<Eigen::Vector3f>().swap(normals_); }

 private:
  rfs_mesh::NeighborTable table_;
  std::vector<Eigen::Vector3f> normals_;
};

/// The frame of point i, and its neighbours in it. Without a normal, or where all neighbours are at the same
/// place, there is no frame. O(1).
TangentFrame tangent_frame(const Positions& points, const NearestRows& near, std::size_t i,
                           TangentNeighbors& around);

}  // namespace rfsmooth::smoothing
