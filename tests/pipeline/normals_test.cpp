#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <string_view>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/normals.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "tests/support/sanitized.h"
#include "tests/support/shapes.h"

namespace rfsmooth::pipeline {
namespace {

using Eigen::Vector3d;
using Flat = std::vector<double>;

Flat row_major(const Positions& points) {
  Flat xyz;
  for (const auto& p : points) xyz.insert(xyz.end(), p.data(), p.data() + 3);
  return xyz;
}

Flat normals_of(const Flat& xyz, const NormalsOptions& options = {}, const Context& context = {}) {
  Flat normals(xyz.size(), 7);
  const auto report = estimate_normals(xyz.data(), xyz.size() / 3, options, context, normals.data());
  EXPECT_TRUE(report.ok()) << report.error().message;
  return normals;
}

Positions normals_of(const Positions& points, const NormalsOptions& options = {}) {
  const Flat normals = normals_of(row_major(points), options);
  Positions rows;
  for (std::size_t i = 0; i < normals.size(); i += 3)
    rows.emplace_back(normals[i], normals[i + 1], normals[i + 2]);
  return rows;
}

/// The share of the points whose normal is within 90 degrees of `truth`.
template <class Truth>
double share_on_side(const Positions& points, const Positions& normals, Truth&& truth) {
  std::size_t right = 0;
  for (std::size_t i = 0; i < points.size(); ++i) right += normals[i].dot(truth(points[i])) > 0 ? 1 : 0;
  return double(right) / double(points.size());
}

Positions moved(Positions points, const Vector3d& by) {
  for (auto& p : points) p += by;
  return points;
}

Positions joined(Positions a, const Positions& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

class ClosedShape : public ::testing::TestWithParam<const char*> {};

TEST_P(ClosedShape, FacesOutwardWithUnitNormals) {
  const auto shape = clouds::make_shape(GetParam());
  const Positions points = clouds::sample(*shape, 4000, 1);
  const Positions normals = normals_of(points);
  const double away = 2 * clouds::mean_spacing(points);
  double angle = 0;
  std::size_t count = 0, wrong = 0, at_edges_wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(normals[i].norm(), 1, 1e-12);
    const double cosine = normals[i].dot(shape->normal(points[i]));
    if (shape->edge_distance(points[i]) < away) {
      at_edges_wrong += cosine < 0 ? 1 : 0;
      continue;
    }
    ++count;
    wrong += cosine < 0 ? 1 : 0;
    angle += std::acos(std::min(1.0, cosine));
  }
  EXPECT_EQ(wrong, 0u);
  // The plate's rim is hardly higher than the spacing: it has no side of its own.
  const bool thin = std::string_view(GetParam()) == "plate";
  EXPECT_LE(at_edges_wrong, thin ? points.size() / 20 : points.size() / 1000);
  EXPECT_LT(angle / double(count), 0.05) << "radians";
}

INSTANTIATE_TEST_SUITE_P(All, ClosedShape,
                         ::testing::Values("sphere", "torus", "cube", "l_part", "plate",
                                           "two_density_sphere"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Normals, StayOnTheirSideUnderNoise) {
  const auto shape = clouds::make_torus();
  Positions points = clouds::sample(*shape, 5000, 1);
  clouds::add_noise(points, clouds::mean_spacing(points), 2);
  EXPECT_GE(share_on_side(points, normals_of(points), [&](const Vector3d& p) { return shape->normal(p); }),
            0.999);
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

TEST(Normals, FaceTheViewpoint) {
  const auto sheet = clouds::make_wavy_sheet();
  const Positions points = clouds::sample(*sheet, 3000, 1);
  for (const double z : {3.0, -3.0}) {
    NormalsOptions options;
    options.viewpoint = Vector3d(0.2, 0.1, z);
    EXPECT_EQ(share_on_side(points, normals_of(points, options),
                            [&](const Vector3d& p) { return Vector3d(*options.viewpoint - p); }),
              1);
  }
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

TEST(Normals, TurnWithTheCloud) {
  const Positions points = clouds::sample(*clouds::make_l_part(), 3000, 1);
  const Positions normals = normals_of(points);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  Positions other;
  for (const auto& p : points) other.emplace_back(250 * (turn * p) + Vector3d(1000, -20, 3));
  const Positions turned = normals_of(other);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT((turned[i] - turn * normals[i]).norm(), 1e-4) << i;
}

TEST(Normals, DoNotDependOnTheOrderOfTheRows) {
  const Positions points = clouds::sample(*clouds::make_cube(), 2000, 1);
  const Positions normals = normals_of(points);
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::reverse(order.begin(), order.end());
  std::swap(order[3], order[1000]);
  Positions shuffled;
  for (const std::size_t i : order) shuffled.push_back(points[i]);
  const Positions other = normals_of(shuffled);
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(other[i], normals[order[i]]);
}

TEST(Normals, RowsThatAreNotFiniteGetNaN) {
  const double nan = std::nan("");
  Flat xyz = row_major(test::poisson_points(test::unit_sphere(), 500, 1));
  const Flat alone = normals_of(xyz);
  xyz.insert(xyz.begin(), {nan, 0, 0});
  const Flat normals = normals_of(xyz);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(std::isnan(normals[k]));
  EXPECT_EQ(std::memcmp(normals.data() + 3, alone.data(), alone.size() * sizeof(double)), 0);
}

TEST(Normals, FewPointsAndPointsInALineGetSomeUnitVector) {
  Positions points;
  EXPECT_FALSE(estimate_normals(nullptr, 0, {}, {}, nullptr).ok()) << "no point at all is an error";
  for (int n = 1; n <= 40; ++n) {
    points.emplace_back(0.5 * n, n, 2 * n);
    for (const auto& normal : normals_of(points)) {
      EXPECT_NEAR(normal.norm(), 1, 1e-12) << n;
      if (n > 1) {
        EXPECT_NEAR(normal.dot(Vector3d(0.5, 1, 2)), 0, 1e-6) << n;
      }
    }
  }
  const Positions same(10, Vector3d(1, 2, 3));
  for (const auto& normal : normals_of(same)) EXPECT_NEAR(normal.norm(), 1, 1e-12);
  const Positions triangle = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const auto& normal : normals_of(triangle)) EXPECT_NEAR(normal[2], 1, 1e-9);
}

TEST(Normals, AreTheSameBytesForAnyNumberOfThreads) {
  Positions points = clouds::sample(*clouds::make_plate(0.06), test::kSanitized ? 2500 : 5000, 1);
  clouds::add_noise(points, 0.015, 2);
  const Flat xyz = row_major(points);
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  EXPECT_EQ(normals_of(xyz, {}, one), normals_of(xyz, {}, four));
  NormalsOptions seen;
  seen.viewpoint = Vector3d(0, 0, 4);
  EXPECT_EQ(normals_of(xyz, seen, one), normals_of(xyz, seen, four));
}

TEST(Normals, AViewpointThatIsNotFiniteIsRefused) {
  const Flat xyz = row_major(test::poisson_points(test::unit_sphere(), 200, 1));
  Flat normals(xyz.size(), 7);
  const NormalsOptions nowhere = {Eigen::Vector3d(0, std::numeric_limits<double>::infinity(), 0)};
  const auto result = estimate_normals(xyz.data(), xyz.size() / 3, nowhere, {}, normals.data());
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_EQ(normals, Flat(xyz.size(), 7));
}

TEST(Normals, CancellingLeavesTheArrayAlone) {
  const Flat xyz = row_major(test::poisson_points(test::unit_sphere(), 2000, 1));
  Flat normals(xyz.size(), 7);
  Context context;
  context.progress = [](std::string_view stage, double) { return stage != "normals"; };
  const auto result = estimate_normals(xyz.data(), xyz.size() / 3, {}, context, normals.data());
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::cancelled);
  EXPECT_EQ(normals, Flat(xyz.size(), 7));
}

}  // namespace
}  // namespace rfsmooth::pipeline
