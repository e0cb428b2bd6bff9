/// Planes through points, for flats.h.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "clouds/shapes/random.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::bench {

struct Plane {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit
  double height(const Eigen::Vector3d& p) const { return normal.dot(p - point); }
  /// Two unit vectors that make a right-handed frame with the normal; one lies in a plane of the coordinates.
  std::array<Eigen::Vector3d, 2> axes() const;
};

/// Least squares over some rows. \throw std::invalid_argument for fewer than three.
Plane fit_plane(const Positions& points, const std::vector<Index>& rows);

/// Least squares, three times over without what is beyond three robust standard deviations of the fit before.
Plane fit_plane_trimmed(const Positions& points, const std::vector<Index>& rows);

/// The standard deviation of the Gaussian noise that has the same distance within which 80 % of the rows are.
/// Not the median: of depths in steps more than half of the points may lie on one step.
double robust_deviation(const Plane& plane, const Positions& points, const std::vector<Index>& rows);

/// RANSAC without a threshold: of `draws` planes through three random rows the one with the least robust
/// deviation (Rousseeuw 1984, Least median of squares regression, with another quantile).
Plane draw_plane(const Positions& points, const std::vector<Index>& rows, int draws, clouds::Random& random);

/// Whether a paraboloid fits the rows hardly better than the plane does: its root mean square is at least
/// 0.8 of the plane's. What bends by less cannot be told from noise that neighbours share.
bool is_flat(const Plane& plane, const Positions& points, const std::vector<Index>& rows);

}  // namespace rfsmooth::bench
