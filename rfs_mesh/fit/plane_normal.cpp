#include "rfs_mesh/fit/plane_normal.h"

#include <Eigen/Geometry>

#include "base/linear/symmetric_eigen.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// A symmetric matrix.
struct Spread {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

/// The least eigenvalue of a positive semi-definite matrix of trace 1: Newton's method on the characteristic
/// polynomial climbs to it from zero.
double least_eigenvalue(const Spread& s) {
  constexpr int kMostSteps = 24;
  constexpr double kSettled = 1e-15;
  const double minors =
      (s.xx * s.yy - s.xy * s.xy) + (s.xx * s.zz - s.xz * s.xz) + (s.yy * s.zz - s.yz * s.yz);
  const double determinant = s.xx * (s.yy * s.zz - s.yz * s.yz) - s.xy * (s.xy * s.zz - s.yz * s.xz) +
                             s.xz * (s.xy * s.yz - s.yy * s.xz);
  double value = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const double slope = minors - value * (2 - 3 * value);
    const double left = determinant - value * (minors - value * (1 - value));
    if (!(slope > 0) || !(left > kSettled * slope)) break;
    value += left / slope;
  }
  return value;
}

/// What the rows of s - value have in common: the largest of their products. Zero where they are parallel.
Eigen::Vector3d null_direction(const Spread& s, double value) {
  const Eigen::Vector3d x(s.xx - value, s.xy, s.xz), y(s.xy, s.yy - value, s.yz), z(s.xz, s.yz, s.zz - value);
  Eigen::Vector3d best = x.cross(y);
  for (const Eigen::Vector3d& other : {Eigen::Vector3d(x.cross(z)), Eigen::Vector3d(y.cross(z))})
    if (other.squaredNorm() > best.squaredNorm()) best = other;
  return best;
}

}  // namespace

Eigen::Vector3d plane_normal(const Positions& points, std::size_t i, Adjacency::Row near) {
  constexpr double kParallel = 1e-6;  // products shorter than this are mostly rounding
  // Moments about the point itself: the centre is subtracted afterwards.
  double x = 0, y = 0, z = 0;
  Spread s;
  const Eigen::Vector3d& p = points[i];
  for (const Index j : near) {
    const Eigen::Vector3d& q = points[j];
    const double u = q[0] - p[0], v = q[1] - p[1], w = q[2] - p[2];
    x += u;
    y += v;
    z += w;
    s.xx += u * u;
    s.xy += u * v;
    s.xz += u * w;
    s.yy += v * v;
    s.yz += v * w;
    s.zz += w * w;
  }
  const double share = 1 / double(near.size() + 1);
  s.xx -= share * x * x;
  s.xy -= share * x * y;
  s.xz -= share * x * z;
  s.yy -= share * y * y;
  s.yz -= share * y * z;
  s.zz -= share * z * z;
  if (const double trace = s.xx + s.yy + s.zz; trace > 0) {
    const double unit = 1 / trace;
    for (double* const m : {&s.xx, &s.xy, &s.xz, &s.yy, &s.yz, &s.zz}) *m *= unit;
    const Eigen::Vector3d normal = null_direction(s, least_eigenvalue(s));
    if (normal.squaredNorm() > kParallel * kParallel) return normal.normalized();
  }
  Eigen::Matrix3d matrix;
  matrix << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  return symmetric_eigen(matrix).vectors.col(0);
}

}  // namespace rfsmooth::rfs_mesh
