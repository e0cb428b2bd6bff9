#include "rfs_mesh/normals/thin_parts.h"

#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace rfsmooth::rfs_mesh {
namespace {

using Eigen::Vector3d;

/// Points with their true normals, and from `thin` on those of a thin part.
struct Oriented {
  Positions points, normals;
  std::size_t thin = 0;

  void add(const Vector3d& p, const Vector3d& n) {
    points.push_back(p);
    normals.push_back(n);
  }
  /// The share of the thin part's normals on the right side.
  double right(const Positions& normals_now) const {
    std::size_t count = 0;
    for (std::size_t i = thin; i < points.size(); ++i) count += normals_now[i].dot(normals[i]) > 0 ? 1 : 0;
    return double(count) / double(points.size() - thin);
  }
};

/// Two square sheets about z = 0 from x on, at most 2 `half`, by default a fifth of a spacing, apart; `side`:
/// 1 for a wall, -1 for a slit.
void add_sheets(Oriented& cloud, double x, double width, double side, double half = 0.005) {
  cloud.thin = cloud.points.size();
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> height(0.1, 1);
  for (const double z : {-1.0, 1.0})
    for (const Vector3d& p :
         test::poisson_points(test::plane(), std::size_t(270 * width * width), z > 0 ? 2 : 3))
      cloud.add({x + width * p[0], width * (p[1] - 0.5), half * z * height(engine)}, {0, 0, side * z});
}

/// The cube [-1, 1]^3.
Oriented cube() {
  Oriented cloud;
  for (const Vector3d& p : test::poisson_points(test::cube(), 6000, 1)) {
    Eigen::Index axis = 0;
    p.cwiseAbs().maxCoeff(&axis);
    cloud.add(p, (p[axis] < 0 ? -1 : 1) * Vector3d::Unit(axis));
  }
  return cloud;
}

/// What neighbours agree on in the thin part: one side for both sheets.
Positions one_sided(const Oriented& cloud) {
  Positions normals = cloud.normals;
  for (std::size_t i = cloud.thin; i < normals.size(); ++i) normals[i] = Vector3d::UnitZ();
  return normals;
}

TEST(ThinParts, BothSidesOfAWallPointOutward) {
  Oriented cloud = cube();
  add_sheets(cloud, 1, 1.5, 1);
  Positions normals = one_sided(cloud);
  EXPECT_LT(cloud.right(normals), 0.55);
  const SpatialIndex index(cloud.points, {});
  EXPECT_GT(turn_out_of_thin_parts(index, normals, {}), 0u);
  EXPECT_GT(cloud.right(normals), 0.9);
  for (const Vector3d& n : normals) EXPECT_NEAR(n.norm(), 1, 1e-12);
}

TEST(ThinParts, MostOfBothSidesOfASlitPointIntoIt) {  // it is narrow: much of it is rim
  Oriented cloud = cube();
  add_sheets(cloud, -0.4, 0.8, -1);
  Positions normals = one_sided(cloud);
  EXPECT_LT(cloud.right(normals), 0.55);
  const SpatialIndex index(cloud.points, {});
  EXPECT_GT(turn_out_of_thin_parts(index, normals, {}), 0u);
  EXPECT_GT(cloud.right(normals), 2.0 / 3);
}

TEST(ThinParts, MostOfAShapeMayBeWall) {
  Oriented cloud = cube();
  add_sheets(cloud, 1, 3.5, 1, 0.04);  // as rough as noise leaves it
  ASSERT_GT(cloud.points.size() - cloud.thin, cloud.thin);
  Positions normals = one_sided(cloud);
  EXPECT_LT(cloud.right(normals), 0.55);
  const SpatialIndex index(cloud.points, {});
  EXPECT_GT(turn_out_of_thin_parts(index, normals, {}), 0u);
  EXPECT_GT(cloud.right(normals), 0.9);
}

/// A ball of radius 1 with a hollow of radius 0.8 and in it a ball of radius 0.6: every sheet looks away from
/// the material.
Oriented nested_spheres() {
  Oriented cloud;
  for (const Vector3d& p : test::poisson_points(test::unit_sphere(), 6000, 1)) cloud.add(p, p);
  for (const Vector3d& p : test::poisson_points(test::unit_sphere(), 3800, 2)) cloud.add(0.8 * p, -p);
  for (const Vector3d& p : test::poisson_points(test::unit_sphere(), 2200, 3)) cloud.add(0.6 * p, p);
  return cloud;
}

/// The lower halves of two spheres of radius 1 and 0.85 and the ring between them: a closed bowl.
Oriented thin_walled_bowl() {
  Oriented cloud;
  for (const Vector3d& p : test::poisson_points(test::unit_sphere(), 8000, 1)) {
    if (p[2] < 0) cloud.add(p, p);
    if (p[2] < 0) cloud.add(0.85 * p, -p);
  }
  for (Vector3d p : test::poisson_points(test::plane(), 3000, 1)) {
    p = {2 * p[0] - 1, 2 * p[1] - 1, 0};
    if (p.norm() < 1 && p.norm() > 0.85) cloud.add(p, Vector3d::UnitZ());
  }
  return cloud;
}

TEST(ThinParts, WhatIsRightStays) {
  for (const Oriented& cloud : {cube(), nested_spheres(), thin_walled_bowl()}) {
    Positions normals = cloud.normals;
    const SpatialIndex index(cloud.points, {});
    EXPECT_EQ(turn_out_of_thin_parts(index, normals, {}), 0u);
    EXPECT_EQ(normals, cloud.normals);
  }
}

TEST(ThinParts, OpenSurfacesStay) {
  // A hemisphere, a bowl of a fifth of the sphere, a tube without its ends, a sheet.
  std::vector<Oriented> clouds(4);
  for (const Vector3d& p : test::poisson_points(test::unit_sphere(), 8000, 1)) {
    if (p[2] < 0) clouds[0].add(p, p);
    if (p[2] < -0.6) clouds[1].add(p, p);
  }
  for (const Vector3d& p : test::poisson_points(test::plane(), 4000, 1)) {
    const double u = 2 * M_PI * p[0];
    clouds[2].add({std::cos(u), std::sin(u), 6 * p[1]}, {std::cos(u), std::sin(u), 0});
    clouds[3].add(p, Vector3d::UnitZ());
  }
  for (const Oriented& cloud : clouds) {
    Positions normals = cloud.normals;
    const SpatialIndex index(cloud.points, {});
    EXPECT_EQ(turn_out_of_thin_parts(index, normals, {}), 0u);
    EXPECT_EQ(normals, cloud.normals);
  }
}

TEST(ThinParts, FewPointsStayAndNumbersMustAgree) {
  const Positions points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  for (std::size_t n = 0; n <= points.size(); ++n) {
    const Positions some(points.begin(), points.begin() + std::ptrdiff_t(n));
    Positions normals(n, Vector3d::UnitZ());
    const SpatialIndex index(some, {});
    EXPECT_EQ(turn_out_of_thin_parts(index, normals, {}), 0u);
  }
  Positions normals(2, Vector3d::UnitZ());
  const SpatialIndex index(points, {});
  EXPECT_THROW(turn_out_of_thin_parts(index, normals, {}), std::invalid_argument);
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
