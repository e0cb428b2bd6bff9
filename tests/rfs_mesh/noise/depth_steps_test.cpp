#include "rfs_mesh/noise/depth_steps.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

using namespace rfsmooth;
using rfs_mesh::DepthSteps;

namespace {

std::optional<DepthSteps> find_depth_steps(const Positions& points,
                                           const std::optional<Eigen::Vector3d>& scanner = std::nullopt) {
  const Context context;
  return rfs_mesh::find_depth_steps(rfs_mesh::SpatialIndex(points, context), scanner);
}

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
    EXPECT_EQ(steps->direction, Eigen::Vector3d::Unit(axis));
    EXPECT_EQ(steps->depths.size(), 21);
    EXPECT_NEAR(steps->typical, 0.05, 1e-12);
  }
}

/// What a camera sees of a wall that leans and is rough: whole centimetres of depth.
Positions wall() {
  Positions points;
  for (int u = -160; u < 160; ++u)
    for (int v = -120; v < 120; ++v) {
      const double z = 2 + 0.01 * ((u * u + 3 * (v + 120)) % 7);
      points.emplace_back(u * z / 350, v * z / 350, z);
    }
  return points;
}

/// A wavy wall in front of a camera that knows whole centimetres: terraces of many points.
Positions terraces() {
  Positions points;
  for (int u = -160; u < 160; ++u)
    for (int v = -120; v < 120; ++v) {
      const double z = 0.01 * std::round(100 * (2 + 0.0002 * u + 0.0006 * v + 0.03 * std::sin(u / 30.0)));
      points.emplace_back(u * z / 350, v * z / 350, z);
    }
  return points;
}

const Eigen::Matrix3d kTurn =
    Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();

/// Turned and moved, in coordinates of single precision.
Positions turned(Positions points) {
  for (Eigen::Vector3d& p : points)
    p = Eigen::Vector3f((kTurn * p + Eigen::Vector3d(4, -2, 3)).cast<float>()).cast<double>();
  return points;
}

TEST(DepthSteps, AreFoundInACloudThatWasTurned) {
  const auto as_taken = find_depth_steps(terraces()), steps = find_depth_steps(turned(terraces()));
  ASSERT_TRUE(as_taken && steps);
  EXPECT_NEAR(std::abs(steps->direction.dot(kTurn.col(2))), 1, 1e-12);
  EXPECT_NEAR(steps->typical, 0.01, 1e-5);
  EXPECT_EQ(steps->depths.size(), as_taken->depths.size());
  const Eigen::Vector3d at = turned({{0.1, 0.1, 2}}).front();
  EXPECT_NEAR(steps->sigma(at, kTurn.col(2)), 0.01 / std::sqrt(12.0), 1e-5);
  EXPECT_NEAR(steps->sigma(at, kTurn.col(0)), 0, 1e-7);
}

TEST(DepthSteps, AreNoneInATurnedGridAndTurnedFreePoints) {
  EXPECT_FALSE(find_depth_steps(turned(stepped(0.05, {}))));
  EXPECT_FALSE(find_depth_steps(turned(stepped(0.05, {0, 1, 2}))));
  Positions smooth;  // a ball, of which every neighbourhood is nearly flat
  for (int i = 0; i < 20000; ++i) {
    const double z = 1 - (2 * i + 1) / 20000.0, r = std::sqrt(1 - z * z), turn = 2.399963 * i;
    smooth.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  EXPECT_FALSE(find_depth_steps(turned(smooth)));
}

TEST(DepthSteps, AreThoseOfTheDepthWhereACameraSeesAWall) {
  const auto steps = find_depth_steps(wall());
  ASSERT_TRUE(steps);
  EXPECT_EQ(steps->direction, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(steps->depths.size(), 7);
  EXPECT_NEAR(steps->typical, 0.01, 1e-12);
}

TEST(DepthSteps, AreNoneInFreePointsAndOnAGrid) {
  EXPECT_FALSE(find_depth_steps(stepped(0.05, {})));
  EXPECT_FALSE(find_depth_steps(stepped(0.05, {0, 1})));
  EXPECT_FALSE(find_depth_steps(stepped(0.05, {0, 1, 2})));
  EXPECT_FALSE(find_depth_steps(stepped(1e-5, {2})));  // as many values as points
  Positions lines;                                     // of which a sample has few points of each
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 1500; ++j) lines.emplace_back(0.3 * i, 0.01 * j, 1e-3 * std::sin(i + j * j));
  EXPECT_FALSE(find_depth_steps(lines));
  EXPECT_FALSE(find_depth_steps(stepped(1, {2})));  // two planes
}

TEST(Grid, IsFoundWhereMostAreAsFarFromTheirNearest) {
  std::vector<double> nearest(1000, 0.05);
  for (std::size_t i = 0; i < nearest.size(); i += 2) nearest[i] *= 1 + 1e-6;  // as files round
  for (std::size_t i = 0; i < nearest.size(); i += 12) nearest[i] *= std::sqrt(2.0);
  const auto grid = rfs_mesh::find_grid(nearest);
  ASSERT_TRUE(grid);
  EXPECT_TRUE(grid->on_grid);
  EXPECT_NEAR(grid->typical, 0.05, 1e-6);
  for (const Eigen::Vector3d& normal : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.6, 0, -0.8)})
    EXPECT_NEAR(grid->sigma({1, 2, 3}, normal), 0.05 / std::sqrt(12.0), 1e-6);
}

TEST(Grid, IsNoneElsewhere) {
  EXPECT_FALSE(rfs_mesh::find_grid({}));
  EXPECT_FALSE(rfs_mesh::find_grid({0, 0, 0}));  // of points that coincide
  std::vector<double> nearest(1000, 0.05);
  for (std::size_t i = 0; i < nearest.size(); i += 3) nearest[i] *= 1.01;
  EXPECT_FALSE(rfs_mesh::find_grid(nearest));
}

/// Points all around a scanner at `scanner`, at ranges of 1 to 3 in whole multiples of `step`, as a file of
/// single precision keeps them.
Positions shells(double step, const Eigen::Vector3d& scanner) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform(1, 3);
  std::normal_distribution<double> normal;
  Positions points;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d ray = Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
    const double range = uniform(engine);
    const Eigen::Vector3f stored = (ray * (step > 0 ? step * std::round(range / step) : range)).cast<float>();
    points.push_back(stored.cast<double>() + scanner);
  }
  return points;
}

TEST(DepthSteps, AreFoundInTheDistanceFromTheScanner) {
  const Eigen::Vector3d scanner(-2, 7, 0.3);
  const auto steps = find_depth_steps(shells(0.01, scanner), scanner);
  ASSERT_TRUE(steps);
  EXPECT_EQ(steps->depths.size(), 201);
  EXPECT_NEAR(steps->typical, 0.01, 1e-6);
  const Eigen::Vector3d ahead = scanner + Eigen::Vector3d(0, 2, 0);
  EXPECT_NEAR(steps->sigma(ahead, {0, 1, 0}), 0.01 / std::sqrt(12.0), 1e-6);
  EXPECT_NEAR(steps->sigma(ahead, Eigen::Vector3d(0, 1, 1).normalized()), 0.01 / std::sqrt(24.0), 1e-6);
  EXPECT_NEAR(steps->sigma(ahead, {1, 0, 0}), 0, 1e-12);
}

TEST(DepthSteps, AreNoneFromElsewhereNorInFreeRanges) {
  const Eigen::Vector3d scanner(-2, 7, 0.3), elsewhere(-2, 7, 0.5);
  EXPECT_FALSE(find_depth_steps(shells(0.01, scanner)));
  EXPECT_FALSE(find_depth_steps(shells(0.01, scanner), elsewhere));
  EXPECT_FALSE(find_depth_steps(shells(0, scanner), scanner));
  EXPECT_FALSE(find_depth_steps(shells(1e-4, scanner), scanner));  // as many as points
  Positions far = shells(0, scanner);  // of seven digits only those are left that all share
  for (auto& p : far) p += Eigen::Vector3d(1e6, 1e6, 0);
  EXPECT_FALSE(find_depth_steps(far, Eigen::Vector3d(0, 0, 0)));
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
  DepthSteps steps;
  steps.depths = {0, 1, 2, 4, 8};
  EXPECT_EQ(steps.gap(1), 1);
  EXPECT_EQ(steps.gap(2), 1.5);
  EXPECT_EQ(steps.gap(4), 3);
  EXPECT_EQ(steps.gap(-5), 1);
  EXPECT_EQ(steps.gap(50), 4);
}

}  // namespace
