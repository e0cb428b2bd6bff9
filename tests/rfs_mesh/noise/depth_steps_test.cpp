#include "rfs_mesh/noise/depth_steps.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

using namespace rfsmooth;
using rfs_mesh::find_depth_steps;

namespace {

/// Random points; the coordinates of `axes` are whole multiples of `step`.
Positions stepped(double step, const std::vector<Eigen::Index>& axes) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> uniform;
  Positions points;
  for (int i = 0; i < 5000; ++i) {
    Eigen::Vector3d p(uniform(engine), uniform(engine), uniform(engine));
    for (const Eigen::Index axis : axes) p[axis] = step * std::round(p[axis] / step);
    points.push_back(p);
  }
  return points;
}

TEST(DepthSteps, AreFoundInWhicheverCoordinateHasThem) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto steps = find_depth_steps(stepped(0.05, {axis}));
    ASSERT_TRUE(steps);
    EXPECT_EQ(steps->axis, axis);
    EXPECT_EQ(steps->depths.size(), 21);
    EXPECT_NEAR(steps->typical, 0.05, 1e-12);
  }
}

TEST(DepthSteps, AreNoneInFreePointsAndOnAGrid) {
  EXPECT_FALSE(find_depth_steps(stepped(0.05, {})));
  EXPECT_FALSE(find_depth_steps(stepped(0.05, {0, 1})));
  EXPECT_FALSE(find_depth_steps(stepped(0.05, {0, 1, 2})));
  EXPECT_FALSE(find_depth_steps(stepped(1e-5, {2})));  // as many values as points
  EXPECT_FALSE(find_depth_steps(stepped(1, {2})));     // two planes
}

TEST(DepthSteps, TheirNoiseIsThatOfRoundingAlongTheNormal) {
  const auto steps = find_depth_steps(stepped(0.05, {2}));
  ASSERT_TRUE(steps);
  const Eigen::Vector3d at(0, 0, 0.4), slanted = Eigen::Vector3d(0, 1, 1).normalized();
  EXPECT_NEAR(steps->sigma(at, {0, 0, 1}), 0.05 / std::sqrt(12.0), 1e-12);
  EXPECT_NEAR(steps->sigma(at, slanted), 0.05 / std::sqrt(24.0), 1e-12);
  EXPECT_EQ(steps->sigma(at, {1, 0, 0}), 0);
}

TEST(DepthSteps, TheGapIsThatOfTheDepth) {
  rfs_mesh::DepthSteps steps;
  steps.depths = {0, 1, 2, 4, 8};
  EXPECT_EQ(steps.gap(1), 1);
  EXPECT_EQ(steps.gap(2), 1.5);
  EXPECT_EQ(steps.gap(4), 3);
  EXPECT_EQ(steps.gap(-5), 1);
  EXPECT_EQ(steps.gap(50), 4);
}

}  // namespace
