/// A quadric fitted robustly to the points around another one: the part of local surfaces (local_surface.h
/// has the formula) and of shared ones (shared_surface.cpp). Internal to the connection stage. Thread safe
/// with one workspace per thread.
#pragma once

#include <vector>

#include <Eigen/Core>

#include <rfsmooth/connect.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::rfs_mesh {

/// Rounds of re-weighting after the first fit; more change nothing visible.
inline constexpr int kRobustRounds = 2;

/// z = c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2 in the frame (t1, t2, n) at `centre`, lengths in units of
/// `radius`.
struct Quadric {
  using Vector3d = Eigen::Vector3d;
  Vector3d centre = Vector3d::Zero(), n = Vector3d::UnitZ(), t1 = Vector3d::UnitX(), t2 = Vector3d::UnitY();
  Eigen::Matrix<double, 6, 1> c = Eigen::Matrix<double, 6, 1>::Zero();
  double radius = 0;    ///< world units; 0: no fit was possible, n is some normal
  double residual = 0;  ///< sqrt(weighted RSS / degrees of freedom), world units

  double height(double u, double v) const {
    return c[0] + u * (c[1] + c[3] * u + c[4] * v) + v * (c[2] + c[5] * v);
  }
  /// The unit normal of the quadric over (u, v).
  Vector3d normal(double u, double v) const {
    return (n - (c[1] + 2 * c[3] * u + c[4] * v) * t1 - (c[2] + c[4] * u + 2 * c[5] * v) * t2).normalized();
  }
};

/// Scratch memory for the neighbours of one point, reused so that nothing is allocated per point. One array
/// per coordinate, padded to whole SIMD vectors with samples of weight zero.
struct QuadricWorkspace {
  std::vector<double> x, y, z;   ///< offsets from the centre, in units of the radius
  std::vector<double> u, v, h;   ///< the same along t1, t2, n
  std::vector<double> nearness;  ///< weights by distance alone
  std::vector<double> weight;    ///< weights by distance and residual: those of the fit
  std::vector<double> residual;  ///< absolute, in units of the radius
  std::vector<double> sorted;    ///< room to find their median
  std::size_t count = 0, padded = 0;
};

/// The quadric at `p` from `count` neighbours and p itself. \param robust_rounds of re-weighting by
/// residuals; with 0 all points within the radius count by their distance alone. O(count).
Quadric fit_quadric(const Positions& points, const Eigen::Vector3d& p, const Index* neighbours,
                    std::size_t count, QuadricWorkspace& workspace, int robust_rounds = kRobustRounds);

/// The local surface at the quadric's centre.
LocalSurface surface_at_centre(const Quadric& quadric);

}  // namespace rfsmooth::rfs_mesh
