/// Directions around a point in its tangent plane; internal to the connection stage.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rfsmooth::rfs_mesh {

/// Degrees to radians.
inline double radians(double degrees) {
  return degrees * (M_PI / 180);
}

/// A right-handed frame (t1, t2, normal).
struct TangentPlane {
  Eigen::Vector3d t1, t2;

  explicit TangentPlane(const Eigen::Vector3d& normal) : t1(normal.unitOrthogonal()), t2(normal.cross(t1)) {}

  Eigen::Vector2d project(const Eigen::Vector3d& d) const { return {t1.dot(d), t2.dot(d)}; }

  /// Direction in (-pi, pi].
  double angle(const Eigen::Vector3d& d) const { return std::atan2(t2.dot(d), t1.dot(d)); }
};

/// The angle in [0, 2 pi) to turn counter-clockwise from `from` to `to`, both in (-pi, pi].
inline double turn(double from, double to) {
  const double t = to - from;  // both lie in (-pi, pi], so one turn is enough
  return t < 0 ? t + 2 * M_PI : t;
}

/// The unsigned angle in [0, pi] between two directions.
inline double between(double a, double b) {
  const double t = turn(a, b);
  return t > M_PI ? 2 * M_PI - t : t;
}

}  // namespace rfsmooth::rfs_mesh
