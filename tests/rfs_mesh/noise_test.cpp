#include "rfsmooth/rfs_mesh/noise.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "support/shapes.h"

using namespace rfsmooth;
using rfs_mesh::measure_noise;
using rfs_mesh::NoiseField;
using rfs_mesh::SpatialIndex;

namespace {

/// 10,000 points of the unit sphere, off it along the normal by sigma(point) x a normal number.
Positions noisy_sphere(const std::function<double(const Eigen::Vector3d&)>& sigma, bool isotropic) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  Positions points;
  const test::Shape sphere = test::unit_sphere();
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Vector3d p = sphere.sample(engine);
    const Eigen::Vector3d noise(normal(engine), normal(engine), normal(engine));
    points.emplace_back(p + sigma(p) * (isotropic ? noise : Eigen::Vector3d(noise.x() * p)));
  }
  return points;
}

NoiseField measured(const Positions& points, int threads = 0) {
  Context context;
  context.threads = threads;
  const SpatialIndex index(points, context);
  return measure_noise(index, context);
}

TEST(Noise, IsMeasuredOnASphereFromATenthToTwoSpacings) {
  const double spacing = std::sqrt(4 * M_PI / 10000);
  for (const bool isotropic : {true, false})
    for (const double share : {0.1, 0.3, 1.0, 2.0}) {
      const double sigma = share * spacing;
      const NoiseField noise = measured(noisy_sphere([&](const auto&) { return sigma; }, isotropic));
      EXPECT_NEAR(noise.sigma / sigma, 1, 0.15) << share << " spacings, isotropic " << isotropic;
    }
}

TEST(Noise, TheFieldFollowsNoiseThatGrowsAcrossTheCloud) {
  const double spacing = std::sqrt(4 * M_PI / 10000);
  const auto sigma = [&](const Eigen::Vector3d& p) { return spacing * (0.5 + 0.3 * (p.z() + 1)); };
  const Positions points = noisy_sphere(sigma, false);
  const NoiseField noise = measured(points);
  ASSERT_EQ(noise.local.size(), points.size());
  double low = 0, high = 0, low_true = 0, high_true = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool upper = points[i].z() > 0.5, lower = points[i].z() < -0.5;
    (upper ? high : low) += upper || lower ? noise.local[i] : 0;
    (upper ? high_true : low_true) += upper || lower ? sigma(points[i].normalized()) : 0;
  }
  EXPECT_NEAR(low / low_true, 1, 0.25);
  EXPECT_NEAR(high / high_true, 1, 0.25);
}

TEST(Noise, ScalesAndTurnsWithTheCloud) {
  const Positions points = noisy_sphere([](const auto&) { return 0.02; }, true);
  const NoiseField here = measured(points);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  Positions there = points;
  for (auto& p : there) p = 1000 * (turn * p) + Eigen::Vector3d(5, -3, 7);
  EXPECT_NEAR(measured(there).sigma, 1000 * here.sigma, 1e-6 * 1000 * here.sigma);
}

TEST(Noise, IsTheSameForAnyNumberOfThreads) {
  const Positions points = noisy_sphere([](const auto&) { return 0.02; }, true);
  const NoiseField one = measured(points, 1), four = measured(points, 4);
  EXPECT_EQ(one.sigma, four.sigma);
  EXPECT_EQ(one.local, four.local);
}

TEST(Noise, OfAFlatCloudIsNothingAndOfAFewPointsZero) {
  Positions plane;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) plane.emplace_back(i, j + 0.3 * (i % 2), 0);
  EXPECT_LT(measured(plane).sigma, 1e-6);
  for (const std::size_t n : {0, 1, 2, 10}) {
    const Positions few(plane.begin(), plane.begin() + std::ptrdiff_t(n));
    EXPECT_EQ(measured(few).sigma, 0) << n;
  }
  const Positions same(100, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(measured(same).sigma, 0);
}

}  // namespace
