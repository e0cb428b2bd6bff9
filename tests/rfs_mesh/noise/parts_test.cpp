#include "rfs_mesh/noise/parts.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

/// n points at random in a square.
Positions square(std::size_t n, double side, double x, std::mt19937_64& engine) {
  std::uniform_real_distribution<double> uniform(0, side);
  Positions points;
  for (std::size_t i = 0; i < n; ++i) points.emplace_back(x + uniform(engine), uniform(engine), 0);
  return points;
}

std::vector<double> bounds_of(const Positions& points) {
  return bounds_of_parts(SpatialIndex(points, {}), {});
}

TEST(Parts, OfAnEvenCloudAreNone) {
  std::mt19937_64 engine(1);
  EXPECT_TRUE(bounds_of(square(5000, 1, 0, engine)).empty());
  EXPECT_TRUE(bounds_of(square(10, 1, 0, engine)).empty());
  EXPECT_TRUE(bounds_of(Positions(100, Eigen::Vector3d::Ones())).empty());
  EXPECT_TRUE(bounds_of({}).empty());
}

// The density of a floor around a scanner falls off 10,000 times, little by little.
TEST(Parts, OfACloudThatGetsSparserWithTheDistanceAreNone) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  Positions points;
  for (int i = 0; i < 20000; ++i) {
    const double r = std::pow(100, uniform(engine)), angle = 2 * M_PI * uniform(engine);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
  }
  EXPECT_TRUE(bounds_of(points).empty());
}

TEST(Parts, OfThreeDensitiesAreThree) {
  std::mt19937_64 engine(3);
  Positions points = square(3000, 1, 0, engine);
  for (const auto& more : {square(2000, 10, 20, engine), square(1000, 100, 200, engine)})
    points.insert(points.end(), more.begin(), more.end());
  const SpatialIndex index(points, {});
  const std::vector<double> bounds = bounds_of_parts(index, {});
  ASSERT_EQ(bounds.size(), 2U);
  const auto rows = rows_of_parts(index, bounds, {});
  ASSERT_EQ(rows.size(), 3U);
  const std::vector<std::size_t> first = {0, 3000, 5000, 6000};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(rows[k].size(), first[k + 1] - first[k]);
    EXPECT_EQ(rows[k].front(), first[k]);
  }
}

}  // namespace
