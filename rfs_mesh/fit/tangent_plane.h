/// Directions around a point in its tangent plane, as angles in radians. Thread safe: no state is kept.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rfsmooth::rfs_mesh {

/// Degrees to radians.
inline double radians(double degrees) {
  return degrees * (M_PI / 180);
}

/// The angle of (x, y) in (-pi, pi], 0 for the zero vector. Within 1.5e-5 radians, a thousandth of a degree,
/// which is finer than every threshold it is used with. Four times as fast as std::atan2; it is called tens
/// of times a point. The minimax polynomial of atan on [0, 1] of degree 11.
inline double direction(double x, double y) {
  const double ax = std::abs(x), ay = std::abs(y), large = std::max(ax, ay), small = std::min(ax, ay);
  const double z = large > 0 ? small / large : 0, s = z * z;
  double angle =
      z * (0.99997726 +
           s * (-0.33262347 + s * (0.19354346 + s * (-0.11643287 + s * (0.05265332 + s * -0.01172120)))));
  angle = ay > ax ? 0.5 * M_PI - angle : angle;
  angle = x < 0 ? M_PI - angle : angle;
  return y < 0 ? -angle : angle;
}

/// A right-handed frame (t1, t2, normal) of unit vectors.
struct TangentPlane {
  Eigen::Vector3d t1, t2;

  /// \param normal unit
  explicit TangentPlane(const Eigen::Vector3d& normal) : t1(normal.unitOrthogonal()), t2(normal.cross(t1)) {}

  Eigen::Vector2d project(const Eigen::Vector3d& d) const { return {t1.dot(d), t2.dot(d)}; }

  /// Direction in (-pi, pi].
  double angle(const Eigen::Vector3d& d) const { return direction(t1.dot(d), t2.dot(d)); }
};

/// The counter-clockwise angle in [0, 2 pi) from `from` to `to`, both in (-pi, pi].
inline double turn(double from, double to) {
  const double t = to - from;  // both lie in (-pi, pi], so one turn is enough
  return t < 0 ? t + 2 * M_PI : t;
}

/// The unsigned angle in [0, pi] between two directions.
inline double between(double a, double b) {
  const double t = turn(a, b);
  return t > M_PI ? 2 * M_PI - t : t;
}

/// The directions up to `width` (at most 2 pi) counter-clockwise of `first`, both ends included; none if the
/// width is negative. `holds` computes no angle.
class Sector {
 public:
  /// \param first, last its ends, of any length; \param width the angle from one to the other, radians
  Sector(const Eigen::Vector2d& first, const Eigen::Vector2d& last, double width)
      : first_(first), last_(last), empty_(!(width >= 0)), narrow_(width <= M_PI) {}

  bool holds(const Eigen::Vector2d& d) const {
    const bool past_first = cross(first_, d) >= 0, before_last = cross(d, last_) >= 0;
    return !empty_ && (narrow_ ? past_first && before_last : past_first || before_last);
  }

 private:
  static double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a[0] * b[1] - a[1] * b[0];
  }
  Eigen::Vector2d first_, last_;
  bool empty_, narrow_;
};

}  // namespace rfsmooth::rfs_mesh
