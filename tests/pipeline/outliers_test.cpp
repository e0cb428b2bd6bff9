/// What is a stray, and what a point of a small or a thin part.
#include "pipeline/outliers.h"

#include <algorithm>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "tests/pipeline/support/found_outliers.h"
#include "tests/support/sanitized.h"

namespace rfsmooth::pipeline {
namespace {

using outliers::count;
using outliers::find;
using outliers::grid;
using outliers::noisy;

TEST(Outliers, AFewStraysTogetherAreFoundToo) {
  Positions points = clouds::sample(*clouds::make_sphere(), 4000, 1);
  const std::size_t n = points.size();
  for (const double x : {2.0, 2.01, 2.02}) points.emplace_back(x, 0, 0);  // three together
  points.emplace_back(0, 0, 0);                                           // inside
  points.emplace_back(0, 0, -30);                                         // far out
  const std::vector<char> flags = find(points);
  EXPECT_EQ(count(flags), 5u);
  for (std::size_t i = n; i < points.size(); ++i) EXPECT_EQ(flags[i], 1) << i;
}

TEST(Outliers, APointBesideARimIsOneIfFarEnough) {
  Positions points = grid(40, 40, 1);
  points.emplace_back(60, 20, 0);    // in the plane, 20 steps beyond the rim
  points.emplace_back(40.5, 20, 0);  // in the plane, just beyond it
  const std::vector<char> flags = find(points);
  EXPECT_EQ(flags[1600], 1);
  EXPECT_EQ(flags[1601], 0);
  EXPECT_EQ(count(flags), 1u);
}

TEST(Outliers, AreTheSameTurnedScaledShuffledAndOnAnyNumberOfThreads) {
  Positions points = noisy(clouds::sample(*clouds::make_torus(), 3000, 1), 0.5);
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int i = 0; i < 40; ++i) points.emplace_back(uniform(engine), uniform(engine), uniform(engine));
  const std::vector<char> flags = find(points, 1);
  ASSERT_GT(count(flags), 10u);
  EXPECT_EQ(find(points, 4), flags);
  if (test::kSanitized) return;  // the threads have been seen
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  Positions turned = points;
  for (auto& p : turned) p = 1000 * (turn * p) + Eigen::Vector3d(500000, 4649776, 130);
  EXPECT_EQ(find(turned), flags);
  Positions backwards(points.rbegin(), points.rend());
  std::vector<char> reversed = find(backwards);
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_EQ(reversed, flags);
}

TEST(Outliers, SmallCloudsHaveNone) {
  for (const std::size_t n : {1, 2, 8, 9, 50, 63}) {
    Positions points = clouds::sample(*clouds::make_sphere(), n, 1);
    points.back() *= 100;
    EXPECT_EQ(count(find(points)), 0u) << n;
  }
  Positions line;
  for (int i = 0; i < 300; ++i) line.emplace_back(i, 0, 0);
  EXPECT_EQ(count(find(line)), 0u);
  EXPECT_TRUE(find_outliers({}, {}).empty());
}

}  // namespace
}  // namespace rfsmooth::pipeline
