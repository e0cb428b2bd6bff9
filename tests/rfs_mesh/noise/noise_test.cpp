#include "rfs_mesh/noise/noise.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/rfs_mesh/noise/measured_noise.h"
#include "tests/support/shapes.h"

using namespace rfsmooth;
using rfs_mesh::NoiseField;
using rfs_mesh::SpatialIndex;

namespace {

using test::kOfSphere;
using test::measured;
using test::noisy_plane;
using test::noisy_sphere;

TEST(Noise, TheFieldFollowsNoiseThatGrowsAcrossTheCloud) {
  const double spacing = std::sqrt(4 * M_PI / kOfSphere);
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

TEST(Noise, AlongARayIsLessWhereTheRayGrazes) {
  // A scanner far away along z: what is seen along the normal is |cos|, here alike on both sides of the
  // sphere.
  const double sigma = std::sqrt(4 * M_PI / 10000);
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal;
  const test::Shape sphere = test::unit_sphere();
  Positions points;
  std::vector<double> truth;
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Vector3d p = sphere.sample(engine);
    points.emplace_back(p + sigma * normal(engine) * Eigen::Vector3d::UnitZ());
    truth.push_back(sigma * std::abs(p.z()));
  }
  const NoiseField noise = measured(points);
  std::vector<double> ratios;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (truth[i] > 0.2 * sigma) ratios.push_back(std::log(noise.local[i] / truth[i]));
  // Up to a common factor: the measured figure is of the calmer places. Of a constant field 0.34.
  const auto median = [](std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  const double middle = median(ratios);
  for (double& r : ratios) r = std::abs(r - middle);
  EXPECT_LT(median(ratios), 0.22);
}

TEST(Noise, BesideASecondSheetIsThatOfOneSheet) {
  // Two sheets fifteen sigma apart, nearer than the sixteenth neighbour.
  Positions points = noisy_plane([](double) { return 0.002; });
  const Positions other = noisy_plane([](double) { return 0.0019; });
  for (const auto& p : other) points.emplace_back(p.y(), p.x(), p.z() + 0.03);
  EXPECT_NEAR(measured(points).sigma / 0.002, 1, 0.2);
}

TEST(Noise, DoesNotDependOnTheOrderOfThePointsButForTheSites) {
  Positions points = noisy_plane([](double) { return 0.004; });
  const double here = measured(points).sigma;
  std::mt19937_64 engine(3);
  std::shuffle(points.begin(), points.end(), engine);
  EXPECT_NEAR(measured(points).sigma / here, 1, 0.1);
}

TEST(Noise, ShapeThatGrowsWithTheNeighbourhoodIsTakenOff) {
  // Waves of 12 spacings: what a quadric leaves of them at 16 points is above the noise of a tenth spacing.
  Positions points = noisy_plane([](double) { return 0.001; });
  for (auto& p : points) p.z() += 0.015 * std::sin(52 * p.x()) * std::sin(52 * p.y());
  const NoiseField noise = measured(points);
  EXPECT_LT(noise.sigma, 0.0015);
  EXPECT_GT(noise.sigma, 0.0005);
  EXPECT_GT(noise.shape, 0.1);
}

TEST(Noise, OnlyPointsOnSeveralLinesLieAlongLines) {
  EXPECT_EQ(measured(noisy_plane([](double) { return 0.002; })).piece, rfs_mesh::kNarrowestPatch);
  EXPECT_EQ(measured(noisy_sphere([](const auto&) { return 0.01; }, true)).piece, rfs_mesh::kNarrowestPatch);
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(0, 0.002);
  Positions line;
  for (double x = 0; x < 20; x += 0.005) line.emplace_back(x, normal(engine), normal(engine));
  const NoiseField alone = measured(line);
  EXPECT_FALSE(alone.on_lines) << "there is no other";
  EXPECT_EQ(alone.piece, rfs_mesh::kNarrowestPatch);
  EXPECT_EQ(alone.shared, 1) << "each has its own noise";
}

TEST(Spacing, FollowsTheDensityAndIsExactOnAGrid) {
  Positions points;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) {
      points.emplace_back(i, j, 0);
      points.emplace_back(1000 + 3 * i, 3 * j, 0);
    }
  const Context context;
  const SpatialIndex index(points, context);
  const std::vector<double> spacing = rfs_mesh::measure_spacing(index, context);
  ASSERT_EQ(spacing.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(spacing[i], points[i].x() < 500 ? 1 : 3, 1e-12) << i;
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
