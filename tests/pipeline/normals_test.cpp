#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/normals.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "tests/pipeline/support/normals_of.h"
#include "tests/support/sanitized.h"
#include "tests/support/shapes.h"

namespace rfsmooth::pipeline {
namespace {

using Eigen::Vector3d;
using test::Flat;
using test::normals_of;
using test::row_major;
using test::share_on_side;

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
