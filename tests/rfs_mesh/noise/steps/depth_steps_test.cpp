#include "rfs_mesh/noise/steps/depth_steps.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "base/quantile.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/noise/steps/rounding.h"

using namespace rfsmooth;
using rfs_mesh::SpatialIndex;
using rfs_mesh::Terraces;

namespace {

std::optional<rfs_mesh::DepthSteps> found_in(const SpatialIndex& index) {
  std::vector<double> nearest = rfs_mesh::nearest_distances(index, {});
  return rfs_mesh::find_depth_steps(index, rfs_mesh::rounding_of(index.points()), quantile(nearest, 0.5));
}

/// The only terraces of the points, if they have any.
std::optional<Terraces> find_terraces(const Positions& points) {
  const Context context;
  const SpatialIndex index(points, context);
  const auto steps = found_in(index);
  if (!steps) return {};
  EXPECT_EQ(steps->terraces().size(), 1);
  EXPECT_EQ(steps->typical(), steps->terraces().front().typical);
  return steps->terraces().front();
}

/// The coordinates of `axes` to whole multiples of `step`.
Positions rounded(Positions points, double step, const std::vector<Eigen::Index>& axes = {0, 1, 2}) {
  for (Eigen::Vector3d& p : points)
    for (const Eigen::Index axis : axes) p[axis] = step * std::round(p[axis] / step);
  return points;
}

/// Random points; the coordinates of `axes` are whole multiples of `step`.
Positions stepped(double step, const std::vector<Eigen::Index>& axes) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> uniform;
  Positions points;
  for (int i = 0; i < 5000; ++i) points.emplace_back(uniform(engine), uniform(engine), uniform(engine));
  return rounded(std::move(points), step, axes);
}

TEST(DepthSteps, AreFoundInWhicheverCoordinateHasThem) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto steps = find_terraces(stepped(0.05, {axis}));
    ASSERT_TRUE(steps);
    EXPECT_EQ(steps->direction, Eigen::Vector3d::Unit(axis));
    EXPECT_EQ(steps->depths.size(), 21);
    EXPECT_NEAR(steps->typical, 0.05, 1e-12);
  }
}

/// A wavy wall in front of a camera that knows depths in such steps: terraces of many points. Spacing 0.0057.
Positions terraces(double step = 0.01) {
  Positions points;
  for (int u = -160; u < 160; ++u)
    for (int v = -120; v < 120; ++v) {
      const double z = step * std::round((2 + 0.0002 * u + 0.0006 * v + 0.03 * std::sin(u / 30.0)) / step);
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
  const auto as_taken = find_terraces(terraces()), steps = find_terraces(turned(terraces()));
  ASSERT_TRUE(as_taken && steps);
  EXPECT_NEAR(std::abs(steps->direction.dot(kTurn.col(2))), 1, 1e-12);
  EXPECT_NEAR(steps->typical, 0.01, 1e-5);
  EXPECT_EQ(steps->depths.size(), as_taken->depths.size());
  const Eigen::Vector3d at = turned({{0.1, 0.1, 2}}).front();
  EXPECT_NEAR(steps->sigma(at, kTurn.col(2)), 0.01 / std::sqrt(12.0), 1e-5);
  EXPECT_NEAR(steps->sigma(at, kTurn.col(0)), 0, 1e-7);
}

TEST(DepthSteps, AreFoundInATurnedCloudOfFewDecimals) {
  const auto steps = find_terraces(rounded(turned(terraces()), 5e-4));
  ASSERT_TRUE(steps);
  EXPECT_NEAR(std::abs(steps->direction.dot(kTurn.col(2))), 1, 1e-8);
  EXPECT_NEAR(steps->typical, 0.01, 5e-4);
}

TEST(DepthSteps, AreFoundWhereCoordinatesWereRoundedSince) {
  for (const double decimals : {1e-3, 2e-3}) {
    const auto steps = find_terraces(rounded(terraces(), decimals));
    ASSERT_TRUE(steps) << decimals;
    EXPECT_EQ(steps->direction, Eigen::Vector3d::UnitZ());
    EXPECT_NEAR(steps->typical, 0.01, decimals);
  }
  // Whole millimetres of a small cloud are few values along every axis.
  const auto steps = find_terraces(rounded(turned(terraces(0.015)), 1e-3));
  ASSERT_TRUE(steps);
  EXPECT_NEAR(std::abs(steps->direction.dot(kTurn.col(2))), 1, 1e-6);
  EXPECT_NEAR(steps->typical, 0.015, 1e-3);
}

// Single precision keeps fewer digits of the larger coordinate: half a metre north of the equator.
TEST(DepthSteps, AreThoseOfTheCoarserAxisOfALattice) {
  const Positions points = rounded(stepped(0.05, {1}), 1.0 / 400, {0});
  for (const bool turn : {false, true}) {
    const auto steps = find_terraces(turn ? turned(points) : points);
    ASSERT_TRUE(steps) << turn;
    const Eigen::Vector3d axis = Eigen::Vector3d::UnitY(),
                          along = turn ? Eigen::Vector3d(kTurn * axis) : axis;
    EXPECT_NEAR(std::abs(steps->direction.dot(along)), 1, 1e-8);
    EXPECT_NEAR(steps->typical, 0.05, 1e-5);
  }
}

// Seven digits of a wide cloud are coarse beside what is near its scanner: there many points are level by
// chance, and most where the ground waves.
TEST(DepthSteps, AreNoneWhereNearPointsAreLevelByChance) {
  for (const double reach : {0.1, 0.2, 0.5})
    for (const double sigma : {2e-4, 1e-3, 2e-3}) {
      std::mt19937_64 engine(6);
      std::uniform_real_distribution<double> uniform;
      std::normal_distribution<double> normal(0, sigma);
      Positions points;
      for (int i = 0; i < 20000; ++i) {
        const bool near = i % 2 == 0;
        const double r = near ? reach * std::sqrt(uniform(engine)) : 50 * uniform(engine),
                     turn = 2 * M_PI * uniform(engine), wave = near ? 0.01 * std::sin(40 * r) : 0;
        points.emplace_back(r * std::cos(turn), r * std::sin(turn), wave + normal(engine));
      }
      EXPECT_FALSE(find_terraces(turned(points))) << reach << ' ' << sigma;
    }
}

// As each ring of a laser has that tells ranges in millimetres, another at every height.
TEST(DepthSteps, OfATurnedCloudCountWhereTheirRoundingIsMoreThanDetail) {
  EXPECT_TRUE(find_terraces(turned(terraces(0.002))));
  EXPECT_FALSE(find_terraces(turned(terraces(0.0005)))) << "a tenth of the spacing";
}

TEST(DepthSteps, OfTwoCamerasAreThoseOfEachWhereItLooked) {
  Positions points = terraces();
  const Positions second = turned(terraces());  // beside the first
  points.insert(points.end(), second.begin(), second.end());
  const Eigen::Vector3d of_first(0.1, 0.1, 2), of_second = turned({of_first}).front(), beside(-5, 0, 0);
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform;
  for (int i = 0; i < 20000; ++i)  // of a sensor without steps
    points.emplace_back(beside + Eigen::Vector3d(uniform(engine), uniform(engine), uniform(engine)));
  const Context context;
  const SpatialIndex index(points, context);
  const auto steps = found_in(index);
  ASSERT_TRUE(steps);
  ASSERT_EQ(steps->terraces().size(), 2);
  EXPECT_NEAR(steps->typical(), 0.01, 1e-5);
  const double rounding = 0.01 / std::sqrt(12.0);
  EXPECT_NEAR(steps->at(of_first).sigma({0, 0, 1}), rounding, 1e-5);
  EXPECT_NEAR(steps->at(of_first).sigma({1, 0, 0}), 0, 1e-7);
  EXPECT_NEAR(steps->at(of_second).sigma(kTurn.col(2)), rounding, 1e-5);
  EXPECT_NEAR(steps->at(of_second).sigma(kTurn.col(0)), 0, 1e-7);
  EXPECT_EQ(steps->at(beside).sigma({0, 0, 1}), 0);
}

TEST(DepthSteps, AreNotTheProfilesOfALineScanner) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal(0, 0.02);
  Positions points;
  for (double y = 0; y < 2; y += 0.1)
    for (double x = 0; x < 2; x += 0.005) points.emplace_back(x + 0.1 * normal(engine), y, normal(engine));
  EXPECT_FALSE(find_terraces(turned(points)));
}

TEST(DepthSteps, AreNoneInATurnedGridAndTurnedFreePoints) {
  EXPECT_FALSE(find_terraces(turned(stepped(0.05, {}))));
  EXPECT_FALSE(find_terraces(turned(stepped(0.05, {0, 1, 2}))));
  Positions smooth;  // a ball, of which every neighbourhood is nearly flat
  for (int i = 0; i < 20000; ++i) {
    const double z = 1 - (2 * i + 1) / 20000.0, r = std::sqrt(1 - z * z), turn = 2.399963 * i;
    smooth.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  EXPECT_FALSE(find_terraces(turned(smooth)));
}

TEST(DepthSteps, AreThoseOfTheDepthWhereACameraSeesAWall) {
  Positions points;
  for (int u = -160; u < 160; ++u)
    for (int v = -120; v < 120; ++v) {
      const double z = 2 + 0.01 * ((u * u + 3 * (v + 120)) % 7);
      points.emplace_back(u * z / 350, v * z / 350, z);
    }
  const auto steps = find_terraces(points);
  ASSERT_TRUE(steps);
  EXPECT_EQ(steps->direction, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(steps->depths.size(), 7);
  EXPECT_NEAR(steps->typical, 0.01, 1e-12);
}

TEST(DepthSteps, AreNoneInFreePointsAndOnAGrid) {
  EXPECT_FALSE(find_terraces(stepped(0.05, {})));
  EXPECT_FALSE(find_terraces(stepped(0.05, {0, 1})));
  EXPECT_FALSE(find_terraces(stepped(0.05, {0, 1, 2})));
  EXPECT_FALSE(find_terraces(stepped(1e-5, {2})));  // as many values as points
  Positions lines;                                  // of which a sample has few points of each
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 1500; ++j) lines.emplace_back(0.3 * i, 0.01 * j, 1e-3 * std::sin(i + j * j));
  EXPECT_FALSE(find_terraces(lines));
  EXPECT_FALSE(find_terraces(stepped(1, {2})));  // two planes
}

TEST(Grid, IsFoundWhereMostAreAsFarFromTheirNearest) {
  std::vector<double> nearest(1000, 0.05);
  for (std::size_t i = 0; i < nearest.size(); i += 2) nearest[i] *= 1 + 1e-6;  // as files round
  for (std::size_t i = 0; i < nearest.size(); i += 12) nearest[i] *= std::sqrt(2.0);
  const auto grid = rfs_mesh::find_grid(nearest, 0);
  ASSERT_TRUE(grid);
  EXPECT_TRUE(grid->on_grid());
  EXPECT_NEAR(grid->typical(), 0.05, 1e-6);
  for (const Eigen::Vector3d& normal : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.6, 0, -0.8)})
    EXPECT_NEAR(grid->at({1, 2, 3}).sigma(normal), 0.05 / std::sqrt(12.0), 1e-6);
}

// Neighbours of a camera's image are eleven millimetres apart, or twelve, in a file of whole millimetres.
TEST(Grid, IsNoneWhereDecimalsMakeDistancesTheSame) {
  const std::vector<double> nearest(100, 11);
  EXPECT_FALSE(rfs_mesh::find_grid(nearest, 1));
  EXPECT_TRUE(rfs_mesh::find_grid(nearest, 11));  // a grid along the axes
  EXPECT_TRUE(rfs_mesh::find_grid(nearest, 1e-6));
}

TEST(Grid, IsNoneElsewhere) {
  EXPECT_FALSE(rfs_mesh::find_grid({}, 0));
  EXPECT_FALSE(rfs_mesh::find_grid({0, 0, 0}, 0));  // of points that coincide
  std::vector<double> nearest(1000, 0.05);
  for (std::size_t i = 0; i < nearest.size(); i += 3) nearest[i] *= 1.01;
  EXPECT_FALSE(rfs_mesh::find_grid(nearest, 0));
}

/// A wall two units before a laser that tells ranges in multiples of `step` (0: any), in a file that rounds
/// to such decimals.
Positions wall_before_laser(double step, double decimals, const Eigen::Vector3d& scanner = {0, 0, 0}) {
  std::mt19937_64 engine(8);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  Positions points;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d at = kTurn * Eigen::Vector3d(uniform(engine), uniform(engine), 2);
    const double range = at.norm() + 0.006 * normal(engine),
                 told = step > 0 ? step * std::round(range / step) : range;
    points.push_back(decimals * ((told * at.normalized() + scanner) / decimals).array().round());
  }
  return points;
}

TEST(DepthSteps, AreFoundInTheDistanceFromTheScannerWhereverItStood) {
  const Eigen::Vector3d scanner(-2, 7, 0.3), ray = kTurn.col(2);
  const auto steps = find_terraces(wall_before_laser(0.01, 1e-7, scanner));
  ASSERT_TRUE(steps);
  ASSERT_TRUE(steps->scanner);
  EXPECT_LT((*steps->scanner - scanner).norm(), 1e-5);
  EXPECT_NEAR(steps->typical, 0.01, 1e-6);
  const Eigen::Vector3d ahead = scanner + 2.2 * ray;
  EXPECT_NEAR(steps->sigma(ahead, ray), 0.01 / std::sqrt(12.0), 1e-5);
  EXPECT_NEAR(steps->sigma(ahead, (ray + kTurn.col(0)).normalized()), 0.01 / std::sqrt(24.0), 1e-5);
  EXPECT_NEAR(steps->sigma(ahead, kTurn.col(0)), 0, 1e-6);
}

TEST(DepthSteps, AreFoundInTheDistanceFromTheScannerWhereFilesKeepFewDecimals) {
  for (const Eigen::Vector3d& scanner : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(-2, 7, 0.3)}) {
    const auto steps = find_terraces(wall_before_laser(0.01, 1e-4, scanner));
    ASSERT_TRUE(steps);
    EXPECT_NEAR(steps->typical, 0.01, 2e-4);
    for (const double decimals : {1e-4, 1e-3})
      EXPECT_FALSE(find_terraces(wall_before_laser(0, decimals, scanner))) << decimals;
  }
}

// Where it saw few points, far away, most of the ranges between are missing.
TEST(DepthSteps, OfALaserAreAsSmallWhereItSawFewPoints) {
  const Eigen::Vector3d scanner(-2, 7, 0.3), ray = kTurn.col(2);
  Positions points = wall_before_laser(0.01, 1e-7, scanner);
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d at = kTurn * Eigen::Vector3d(uniform(engine), uniform(engine), 4);
    points.push_back(scanner + 0.01 * std::round(200 * (3 + uniform(engine))) * at.normalized());
  }
  const auto steps = find_terraces(points);
  ASSERT_TRUE(steps);
  EXPECT_NEAR(steps->typical, 0.01, 1e-6);
  for (const double range : {2.1, 5.0, 7.5})
    EXPECT_NEAR(steps->sigma(scanner + range * ray, ray), 0.01 / std::sqrt(12.0), 1e-5) << range;
}

TEST(DepthSteps, AreNoneInFreeRanges) {
  for (const double step : {0.0, 1e-4})  // as many as points
    EXPECT_FALSE(find_terraces(wall_before_laser(step, 1e-7, {-2, 7, 0.3})));
  // Of seven digits only those are left that all share.
  EXPECT_FALSE(find_terraces(wall_before_laser(0, 0.125, {1e6, 1e6, 0})));
}

TEST(DepthSteps, OfTwoScannersAreThoseOfEachWhereItStood) {
  const Eigen::Vector3d first(4, -2, 3), second(4, 28, 3), ray = kTurn.col(2);
  Positions points = wall_before_laser(0.01, 1e-7, first);
  for (const Eigen::Vector3d& p : wall_before_laser(0.01, 1e-7, second)) points.push_back(p);
  const Context context;
  const SpatialIndex index(points, context);
  const auto steps = found_in(index);
  ASSERT_TRUE(steps);
  ASSERT_EQ(steps->terraces().size(), 2);
  for (const Eigen::Vector3d& scanner : {first, second})
    EXPECT_NEAR(steps->at(scanner + 2.1 * ray).sigma(ray), 0.01 / std::sqrt(12.0), 1e-4);
}

// Its rings are as far from the points of its axis, and, if evenly spaced, in steps along that.
TEST(DepthSteps, AreNotTheRingsOfALathesPart) {
  Positions vase;
  for (int ring = 0; ring < 120; ++ring)
    for (int k = 0; k < 100; ++k) {
      const double z = ring / 60.0, r = 1 + 0.3 * std::sin(3 * z), turn = 2 * M_PI * k / 100;
      vase.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    }
  EXPECT_FALSE(find_terraces(vase));
  EXPECT_FALSE(find_terraces(turned(vase)));
}

/// The points, and a fiftieth as many anywhere in their box.
Positions among_clutter(Positions points) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform;
  Eigen::AlignedBox3d box;
  for (const auto& p : points) box.extend(p);
  for (std::size_t n = points.size() / 50; n > 0; --n) {
    const Eigen::Array3d at(uniform(engine), uniform(engine), uniform(engine));
    points.push_back(box.min() + (at * box.sizes().array()).matrix());
  }
  return points;
}

TEST(DepthSteps, AreFoundAmongPointsThatLieFree) {
  const auto steps = find_terraces(among_clutter(stepped(0.05, {2})));
  ASSERT_TRUE(steps);
  EXPECT_EQ(steps->direction, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(steps->depths.size(), 21);
  const auto ranges = find_terraces(among_clutter(wall_before_laser(0.01, 1e-7, {-2, 7, 0.3})));
  ASSERT_TRUE(ranges);
  EXPECT_NEAR(ranges->typical, 0.01, 1e-6);
}

TEST(DepthSteps, TheirNoiseIsThatOfRoundingAlongTheNormal) {
  const auto steps = find_terraces(stepped(0.05, {2}));
  ASSERT_TRUE(steps);
  const Eigen::Vector3d at(0, 0, 0.4), slanted = Eigen::Vector3d(0, 1, 1).normalized();
  EXPECT_NEAR(steps->sigma(at, {0, 0, 1}), 0.05 / std::sqrt(12.0), 1e-12);
  EXPECT_NEAR(steps->sigma(at, slanted), 0.05 / std::sqrt(24.0), 1e-12);
  EXPECT_EQ(steps->sigma(at, {1, 0, 0}), 0);
  const rfs_mesh::DepthSteps grid(0.05);
  EXPECT_NEAR(grid.at(at).sigma(slanted), 0.05 / std::sqrt(12.0), 1e-12);
  EXPECT_EQ(grid.at(at).width(slanted), 0);
}

TEST(DepthSteps, TheGapIsThatOfTheDepth) {
  Terraces steps;
  steps.depths = {0, 1, 2, 4, 8};
  EXPECT_EQ(steps.gap(1), 1);
  EXPECT_EQ(steps.gap(2), 1.5);
  EXPECT_EQ(steps.gap(4), 3);
  EXPECT_EQ(steps.gap(-5), 1);
  EXPECT_EQ(steps.gap(50), 4);
}

}  // namespace
