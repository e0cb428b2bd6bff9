#include "rfs_mesh/normals/wall_sides.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace rfsmooth::rfs_mesh {
namespace {

using Eigen::Vector3d;

/// Two sheets over the unit square, `apart` spacings from each other and scattered by 0.15; `side`: 1 with
/// the solid between them (a wall), -1 with the solid around (a slit).
struct WallSheets {
  Positions points, normals;

  WallSheets(double apart, double side) {
    constexpr std::size_t kPoints = 2500;
    const double spacing = 0.8 / std::sqrt(double(kPoints));
    std::mt19937_64 engine(3);
    std::normal_distribution<double> noise(0, 0.15 * spacing);
    for (const double z : {-1.0, 1.0})
      for (const Vector3d& p : test::poisson_points(test::plane(), kPoints, z > 0 ? 2 : 3)) {
        points.emplace_back(p.x(), p.y(), z * apart * spacing / 2 + noise(engine));
        normals.emplace_back(0, 0, side * z);
      }
  }

  /// Every twentieth normal the wrong way round.
  Positions muddled() const {
    Positions wrong = normals;
    std::mt19937_64 engine(4);
    for (auto& n : wrong)
      if (engine() % 20 == 0) n = -n;
    return wrong;
  }

  double right(const Positions& now) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < now.size(); ++i) count += now[i].dot(normals[i]) > 0 ? 1 : 0;
    return double(count) / double(now.size());
  }
};

NeighborTable near_of(const Positions& points) {
  return SpatialIndex(points, {}).nearest(128, {});
}

TEST(WallSides, PointsFaceTheWayOfTheSheetTheyLieOn) {
  for (const double apart : {1.0, 2.0, 3.0}) {
    const WallSheets wall(apart, 1);
    Positions normals = wall.muddled();
    ASSERT_LT(wall.right(normals), 0.96);
    EXPECT_GT(turn_to_own_sheet(wall.points, near_of(wall.points), normals, {}), 0u);
    EXPECT_GT(wall.right(normals), 0.995) << apart;
    for (const Vector3d& n : normals) EXPECT_EQ(n.norm(), 1);
  }
}

TEST(WallSides, WhatIsRightStays) {
  for (const double side : {1.0, -1.0}) {
    const WallSheets sheets(2, side);
    Positions normals = sheets.normals;
    EXPECT_EQ(turn_to_own_sheet(sheets.points, near_of(sheets.points), normals, {}), 0u);
    EXPECT_EQ(normals, sheets.normals);
  }
  Positions sphere = test::poisson_points(test::unit_sphere(), 5000, 1), normals = sphere;
  for (auto& n : normals) n.normalize();
  const Positions before = normals;
  EXPECT_EQ(turn_to_own_sheet(sphere, near_of(sphere), normals, {}), 0u);
  EXPECT_EQ(normals, before);
}

TEST(WallSides, TurnsWithTheCloud) {
  const WallSheets wall(2, 1);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  Positions normals = wall.muddled(), points = wall.points, turned = normals;
  for (auto& p : points) p = 5 * (turn * p) + Vector3d(1, 2, 3);
  for (auto& n : turned) n = turn * n;
  turn_to_own_sheet(wall.points, near_of(wall.points), normals, {});
  turn_to_own_sheet(points, near_of(points), turned, {});
  std::size_t different = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) different += turned[i].dot(turn * normals[i]) > 0 ? 0 : 1;
  EXPECT_LE(different, 2u);  // halfway between both
}

TEST(WallSides, SameForAnyNumberOfThreads) {
  const WallSheets wall(2, 1);
  Positions one = wall.muddled(), four = one;
  Context context;
  context.threads = 1;
  turn_to_own_sheet(wall.points, near_of(wall.points), one, context);
  context.threads = 4;
  turn_to_own_sheet(wall.points, near_of(wall.points), four, context);
  EXPECT_EQ(one, four);
}

TEST(WallSides, SizesMustAgree) {
  const WallSheets wall(2, 1);
  Positions few(10, Vector3d::UnitZ());
  EXPECT_THROW(turn_to_own_sheet(wall.points, near_of(wall.points), few, {}), std::invalid_argument);
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
