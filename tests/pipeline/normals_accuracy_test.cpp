/// How many points have their normals on the right side.
#include <cstddef>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <rfsmooth/normals.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "tests/pipeline/support/normals_of.h"
#include "tests/support/shapes.h"

namespace rfsmooth::pipeline {
namespace {

using Eigen::Vector3d;
using test::normals_of;
using test::share_on_side;

Positions moved(Positions points, const Vector3d& by) {
  for (auto& p : points) p += by;
  return points;
}

Positions joined(Positions a, const Positions& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(Normals, SheetsOfAThinPlateThatNoiseHasMixedAreToldApart) {
  const auto shape = clouds::make_plate(0.12);
  Positions points = clouds::sample(*shape, 6000, 1);
  clouds::add_noise(points, 0.2 * 0.12, 2);  // the sheets are five sigma apart
  EXPECT_GE(share_on_side(points, normals_of(points), [&](const Vector3d& p) { return shape->normal(p); }),
            0.97);
}

TEST(Normals, BothSidesOfABladeThatHasRunTogetherFaceOutward) {
  // A cube with a blade on one face, a fifth of a spacing thick where its points are, as smoothing leaves it.
  Positions points = test::poisson_points(test::cube(), 6000, 1), blade;
  for (const double z : {-1.0, 1.0})
    for (const auto& p : test::poisson_points(test::plane(), 600, z > 0 ? 2 : 3))
      blade.emplace_back(1 + 1.5 * p[0], 1.5 * p[1] - 0.75, 0.005 * z);
  points = joined(points, blade);
  const Positions normals = normals_of(points);
  const auto middle = normals.end() - std::ptrdiff_t(blade.size());
  EXPECT_GE(share_on_side(blade, Positions(middle, normals.end()),
                          [](const Vector3d& p) { return Vector3d(0, 0, p[2]); }),
            0.9);
}

TEST(Normals, EveryClosedPieceFacesOutwardAndTheWallOfACavityFacesTheCavity) {
  const Positions ball = test::poisson_points(test::unit_sphere(), 2000, 1);
  Positions large;
  for (const auto& p : test::poisson_points(test::unit_sphere(), 4000, 2)) large.emplace_back(2 * p);
  const auto from_centre = [](const Vector3d& p) { return p; };

  const Positions apart = joined(ball, moved(ball, {5, 0, 0}));
  EXPECT_EQ(share_on_side(apart, normals_of(apart),
                          [](const Vector3d& p) { return Vector3d(p[0] > 2.5 ? p - Vector3d(5, 0, 0) : p); }),
            1);
  const Positions nested = joined(large, ball);
  const Positions normals = normals_of(nested);
  const Positions outer(normals.begin(), normals.begin() + std::ptrdiff_t(large.size()));
  const Positions inner(normals.begin() + std::ptrdiff_t(large.size()), normals.end());
  EXPECT_EQ(share_on_side(large, outer, from_centre), 1);
  EXPECT_EQ(share_on_side(ball, inner, from_centre), 0);
}

TEST(Normals, NestedSpheresLookAwayFromTheMaterialBetweenThem) {
  Positions points;
  for (const double radius : {1.0, 0.8, 0.6})
    for (const Vector3d& p :
         test::poisson_points(test::unit_sphere(), std::size_t(5000 * radius * radius), 1))
      points.push_back(radius * p);
  EXPECT_GT(share_on_side(points, normals_of(points),
                          [](const Vector3d& p) {
                            const double r = p.norm();
                            return Vector3d(r > 0.7 && r < 0.9 ? -p : p);
                          }),
            0.995);
}

TEST(Normals, BothSidesOfTheWallOfABowlAndItsRimLookOutOfTheWall) {
  constexpr double kInner = 0.85;
  Positions points;
  for (const Vector3d& p : test::poisson_points(test::unit_sphere(), 12000, 1))
    if (p[2] < 0) points.push_back(p);
  for (const Vector3d& p : test::poisson_points(test::unit_sphere(), 9000, 2))
    if (p[2] < 0) points.push_back(kInner * p);
  for (const Vector3d& p : test::poisson_points(test::plane(), 3800, 3)) {
    const Vector3d q(2 * p[0] - 1, 2 * p[1] - 1, 0);
    if (q.norm() < 1 && q.norm() > kInner) points.push_back(q);
  }
  const double share = share_on_side(points, normals_of(points), [](const Vector3d& p) {
    if (p[2] == 0) return Vector3d(Vector3d::UnitZ());
    return Vector3d(p.norm() > 0.5 * (1 + kInner) ? p : -p);
  });
  EXPECT_GT(share, 0.995) << "at the two edges of the rim a normal may take the other face's side";
}

TEST(Normals, AnOpenSheetHasOneSide) {
  const auto sheet = clouds::make_wavy_sheet();
  const Positions points = clouds::sample(*sheet, 4000, 1);
  const double up =
      share_on_side(points, normals_of(points), [&](const Vector3d& p) { return sheet->normal(p); });
  EXPECT_TRUE(up == 0 || up == 1) << up;
  const Positions plane = test::poisson_points(test::plane(), 2000, 1);
  EXPECT_EQ(share_on_side(plane, normals_of(plane), [](const Vector3d&) { return Vector3d::UnitZ(); }), 1)
      << "flat: no outward, so up";
}

TEST(Normals, WhatTheViewpointDoesNotSeeFollows) {
  const Positions ball = test::poisson_points(test::unit_sphere(), 3000, 1);
  NormalsOptions outside, inside;
  outside.viewpoint = Vector3d(3, 2, 1);
  inside.viewpoint = Vector3d(0.3, 0, 0.2);
  const auto from_centre = [](const Vector3d& p) { return p; };
  EXPECT_EQ(share_on_side(ball, normals_of(ball, outside), from_centre), 1) << "its far half, too";
  EXPECT_EQ(share_on_side(ball, normals_of(ball, inside), from_centre), 0) << "a room from inside";
}

}  // namespace
}  // namespace rfsmooth::pipeline
