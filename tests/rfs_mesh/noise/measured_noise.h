/// Noisy spheres and planes, and the noise that is measured on a cloud.
#pragma once

#include <functional>
#include <random>

#include <Eigen/Core>

#include "rfs_mesh/noise/noise.h"
#include "tests/support/shapes.h"

namespace rfsmooth::test {

inline constexpr int kOfSphere = 5000;

inline rfs_mesh::NoiseField measured(const Positions& points, int threads = 0) {
  Context context;
  context.threads = threads;
  const rfs_mesh::SpatialIndex index(points, context);
  return rfs_mesh::spread_noise(rfs_mesh::measure_noise(index, context), points, context);
}

/// So many points of the unit sphere, off it along the normal by sigma(point) x a normal number.
inline Positions noisy_sphere(const std::function<double(const Eigen::Vector3d&)>& sigma, bool isotropic) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  Positions points;
  const Shape sphere = unit_sphere();
  for (int i = 0; i < kOfSphere; ++i) {
    const Eigen::Vector3d p = sphere.sample(engine);
    const Eigen::Vector3d noise(normal(engine), normal(engine), normal(engine));
    points.emplace_back(p + sigma(p) * (isotropic ? noise : Eigen::Vector3d(noise.x() * p)));
  }
  return points;
}

/// 100 x 100 points over [0, 1]^2, jittered, with normal noise of sigma(x) along z.
inline Positions noisy_plane(const std::function<double(double)>& sigma) {
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  Positions points;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) {
      const double x = (i + 0.5 + jitter(engine)) / 100, y = (j + 0.5 + jitter(engine)) / 100;
      points.emplace_back(x, y, sigma(x) * normal(engine));
    }
  return points;
}

}  // namespace rfsmooth::test
