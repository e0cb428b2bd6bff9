/// Clouds that were merged with a copy of themselves, rounded or moved a little.
#include "pipeline/twins.h"

#include <random>

#include <gtest/gtest.h>

#include <rfsmooth/denoise.h>

#include "tests/pipeline/noise/noisy_sphere.h"
#include "tests/support/threads.h"

namespace rfsmooth::pipeline {
namespace {

using noisy::denoise;

Positions noisy_sphere(double noise) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal(0, noise * noisy::spacing());
  return noisy::off_sphere([&](std::size_t) { return normal(engine); });
}

/// The points, and behind them so many of them again, off by as much in each coordinate.
Positions with_twins(Positions points, std::size_t twins, double off) {
  std::mt19937_64 engine(6);
  std::uniform_real_distribution<double> uniform(-off, off);
  for (std::size_t i = 0; i < twins; ++i)
    points.push_back(points[i] + Eigen::Vector3d(uniform(engine), uniform(engine), uniform(engine)));
  return points;
}

rfs_mesh::WorkingCloud working(const Positions& points) {
  auto cloud = rfs_mesh::make_working_cloud(points.front().data(), points.size(), {});
  EXPECT_TRUE(cloud);
  return std::move(cloud.value());
}

bool join(rfs_mesh::WorkingCloud& cloud, std::size_t near = 16) {
  const rfs_mesh::SpatialIndex index(cloud.points, {});
  return join_twins(index.nearest(int(near), {}), cloud, {});
}

class Twins : public ::testing::TestWithParam<double> {};

TEST_P(Twins, AreSmoothedLikeTheCloudWithoutThem) {
  const Positions alone = noisy_sphere(0.3);
  const std::size_t n = alone.size();
  const Positions before = with_twins(alone, n, GetParam() * noisy::spacing());
  Positions after = before;
  const DenoiseReport report = denoise(after);
  EXPECT_NEAR(report.spacing, noisy::spacing(), 0.1 * noisy::spacing());
  const double of_alone = support::rms_off_unit_sphere(noisy::denoised(alone));
  EXPECT_LT(support::rms_off_unit_sphere(after), 1.2 * of_alone + 0.03 * noisy::spacing());
  for (std::size_t i = 0; i < n; ++i)
    ASSERT_LT(((after[i] - before[i]) - (after[n + i] - before[n + i])).norm(), 1e-12) << i;
}

INSTANTIATE_TEST_SUITE_P(Spacings, Twins, ::testing::Values(1e-7, 1e-3, 0.02));

TEST(Twins, ShareAPointAndNoneIsLost) {
  const Positions alone = noisy_sphere(0.3);
  const std::size_t n = alone.size();
  rfs_mesh::WorkingCloud cloud = working(with_twins(alone, n / 2, 1e-9));
  ASSERT_TRUE(join(cloud));
  EXPECT_EQ(cloud.points.size(), n);
  for (std::size_t i = 0; i < n / 2; ++i) {
    ASSERT_EQ(cloud.of_input[i], cloud.of_input[n + i]) << i;
    // One of the two is the point, and the other moves like it.
    ASSERT_TRUE((cloud.like[i] == n + i && cloud.like[n + i] == kNone) ||
                (cloud.like[n + i] == i && cloud.like[i] == kNone))
        << i;
  }
  for (std::size_t i = n / 2; i < n; ++i) ASSERT_EQ(cloud.like[i], kNone);
}

TEST(Twins, AreNoneWhereFewPointsAreNearByChance) {
  const Positions alone = noisy_sphere(0.3);
  for (const std::size_t twins : {std::size_t(0), alone.size() / 30}) {
    rfs_mesh::WorkingCloud cloud = working(with_twins(alone, twins, 1e-9));
    const Positions before = cloud.points;
    EXPECT_FALSE(join(cloud));
    EXPECT_TRUE(cloud.points == before);
    EXPECT_TRUE(cloud.like.empty());
  }
  rfs_mesh::WorkingCloud cloud = working(with_twins(alone, alone.size(), 1e-9));
  EXPECT_FALSE(join(cloud, 7)) << "seven neighbours do not tell how far the eighth is";
}

TEST(Twins, OfACleanCloudStay) {
  Positions points = with_twins(noisy::sphere(), noisy::sphere().size(), 1e-9);
  const Positions before = points;
  denoise(points);
  EXPECT_TRUE(points == before);
}

TEST(Twins, OfOutliersStayOrLandWithThem) {
  Positions points = noisy_sphere(0.3);
  for (int i = 0; i < 20; ++i) points[std::size_t(i) * 500] *= 1.5;
  points = with_twins(points, points.size(), 1e-9);
  const Positions before = points;
  const DenoiseReport report = denoise(points);
  EXPECT_EQ(report.outliers, 40u);
  for (std::size_t i = 0; i < report.outlier.size(); ++i)
    if (report.outlier[i] != 0) {
      EXPECT_TRUE(points[i] == before[i]) << i;
    }
}

TEST(Twins, OfARowThatIsToStayStay) {
  const Positions alone = noisy_sphere(0.3);
  const std::size_t n = alone.size();
  const Positions before = with_twins(alone, n, 1e-9);
  for (const bool first : {true, false}) {
    SCOPED_TRACE(first);
    std::vector<double> strength(2 * n, 1);
    for (std::size_t i = 0; i < n / 2; ++i) strength[first ? i : n + i] = 0;
    Positions after = before;
    ASSERT_TRUE(rfsmooth::denoise(after.front().data(), 2 * n, {}, {}, strength).ok());
    std::size_t moved = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const bool stays = after[i] == before[i] && after[n + i] == before[n + i];
      if (i < n / 2) {
        ASSERT_TRUE(stays) << i;
      } else {
        moved += stays ? 0 : 1;
      }
    }
    EXPECT_GT(moved, n / 3);
  }
}

}  // namespace
}  // namespace rfsmooth::pipeline
