/// How points lie about their mean: the plane through them and their spread along its axes (principal
/// component analysis). Thread safe.
#pragma once

#include <vector>

#include <rfsmooth/mesh.h>

#include "base/linear/symmetric_eigen.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The weighted mean of some points, and their axes about it.
struct PrincipalAxes {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  SymmetricEigen<3> axes;  ///< values: sums of w d^2 along each, ascending; the first is the plane's normal
};

/// \param near one point or more \param weight of a Neighbor, > 0 for one at least. O(|near|).
template <class Weight>
PrincipalAxes principal_axes(const Positions& points, const std::vector<Neighbor>& near,
                             const Weight& weight) {
  PrincipalAxes found;
  double weights = 0;
  for (const Neighbor& q : near) {
    const double w = weight(q);
    found.mean += w * points[q.index];
    weights += w;
  }
  found.mean /= weights;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Neighbor& q : near) {
    const Eigen::Vector3d d = points[q.index] - found.mean;
    spread += weight(q) * d * d.transpose();
  }
  found.axes = symmetric_eigen(spread);
  return found;
}

/// All of them weigh the same.
inline PrincipalAxes principal_axes(const Positions& points, const std::vector<Neighbor>& near) {
  return principal_axes(points, near, [](const Neighbor&) { return 1.0; });
}

}  // namespace rfsmooth::rfs_mesh
