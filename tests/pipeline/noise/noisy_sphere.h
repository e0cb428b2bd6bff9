/// A sphere whose points are off it as a test says, and how far off they are once `denoise` is done.
#pragma once

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include <rfsmooth/denoise.h>

#include "rfs_mesh/fit/local_surface.h"
#include "tests/support/meshes.h"

namespace rfsmooth::noisy {

/// 10,242 points of the unit sphere.
inline const Positions& sphere() {
  static const Positions points = support::icosphere(5).positions;
  return points;
}

inline double spacing() {
  static const double mean =
      rfs_mesh::mean_spacing(rfs_mesh::nearest_distances(rfs_mesh::SpatialIndex(sphere(), {}), {}), {});
  return mean;
}

/// Along the normals, by point.
inline Positions off_sphere(const std::function<double(std::size_t)>& height) {
  Positions points = sphere();
  for (std::size_t i = 0; i < points.size(); ++i) points[i] *= 1 + height(i);
  return points;
}

/// By the automatic flow, in place.
inline DenoiseReport denoise(Positions& points, double strength = 1) {
  DenoiseOptions options;
  AutomaticOptions automatic;
  automatic.strength = strength;
  options.flow.flow = automatic;
  const auto report = rfsmooth::denoise(points.front().data(), points.size(), options, {});
  EXPECT_TRUE(report);
  return report ? report.value() : DenoiseReport();
}

inline Positions denoised(Positions points, double strength = 1) {
  denoise(points, strength);
  return points;
}

inline double rms_off(const Positions& points, const std::function<bool(std::size_t)>& counts) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!counts(i)) continue;
    sum += std::pow(points[i].norm() - 1, 2);
    ++count;
  }
  return std::sqrt(sum / count);
}

inline bool everywhere(std::size_t) {
  return true;
}

inline double rms(const Positions& points, const std::function<double(const Eigen::Vector3d&)>& off) {
  double sum = 0;
  for (const Eigen::Vector3d& p : points) sum += std::pow(off(p), 2);
  return std::sqrt(sum / double(points.size()));
}

/// Of the heights over z = `level`.
inline double rms_height(const Positions& points, double level) {
  double sum = 0;
  for (const Eigen::Vector3d& p : points) sum += std::pow(p.z() - level, 2);
  return std::sqrt(sum / double(points.size()));
}

inline double rms_move(const Positions& from, const Positions& to) {
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += (to[i] - from[i]).squaredNorm();
  return std::sqrt(sum / double(from.size()));
}

}  // namespace rfsmooth::noisy
