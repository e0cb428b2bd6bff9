#include "rfs_mesh/connect/umbrella.h"

#include <cmath>
#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "rfs_mesh/measure.h"
#include "tests/support/awkward_clouds.h"
#include "tests/support/shapes.h"
#include "tests/support/test_ground.h"

namespace rfsmooth::rfs_mesh {
namespace {

using test::TestGround;

std::vector<Umbrella> umbrellas_over(const TestGround& ground) {
  return open_umbrellas(ground.terrain(), ground.sdg().graph, {}, {});
}

/// Counter-clockwise about `normal` from a to b, in [0, 2 pi).
double ccw_angle(const Eigen::Vector3d& normal, Eigen::Vector3d a, Eigen::Vector3d b) {
  a -= normal * normal.dot(a);
  b -= normal * normal.dot(b);
  const double angle = std::atan2(normal.dot(a.cross(b)), a.dot(b));
  return angle < 0 ? angle + 2 * M_PI : angle;
}

/// Rounding of the directions that umbrellas are sorted by (tangent_plane.h).
constexpr double kDirection = 1e-4;

/// What holds of every umbrella.
void expect_sound_umbrellas(const TestGround& ground, const std::vector<Umbrella>& umbrellas) {
  ASSERT_EQ(umbrellas.size(), ground.points.size());
  const UmbrellaOptions options;
  for (Index v = 0; v < umbrellas.size(); ++v) {
    const Umbrella& u = umbrellas[v];
    ASSERT_LE(int(u.count), kMostRibs);
    const std::set<Index> ribs(u.ribs.begin(), u.ribs.begin() + u.count);
    EXPECT_EQ(ribs.size(), std::size_t(u.count)) << "a rib twice";
    EXPECT_EQ(ribs.count(v), 0u) << "a rib to itself";
    EXPECT_LT(int(u.faces), 1 << u.count) << "a face without a rib";
    const Eigen::Vector3d &at = ground.points[v], &normal = ground.surfaces[v].normal;
    double around = 0;
    for (int k = 0; k < u.count; ++k) {
      const Index a = u.ribs[std::size_t(k)], b = u.next(k);
      const double gap =
          u.count == 1 ? 2 * M_PI : ccw_angle(normal, ground.points[a] - at, ground.points[b] - at);
      around += gap;
      if (!u.spans(k)) continue;
      EXPECT_LE(gap, options.face_angle * M_PI / 180 + kDirection);
      EXPECT_GE(face_quality(at, ground.points[a], ground.points[b]), options.quality);
    }
    if (u.count > 0) {
      EXPECT_NEAR(around, 2 * M_PI, 1e-9 + kDirection) << "ribs are sorted around the vertex once";
    }
  }
}

class UmbrellasOfShape : public testing::TestWithParam<test::Shape> {};

TEST_P(UmbrellasOfShape, AreSortedApartAndOfGoodFaces) {
  const TestGround ground(test::random_points(GetParam(), 2000, 1));
  const std::vector<Umbrella> umbrellas = umbrellas_over(ground);
  expect_sound_umbrellas(ground, umbrellas);
  const double apart = UmbrellaOptions().rib_angle * M_PI / 180;
  std::size_t faces = 0;
  for (Index v = 0; v < umbrellas.size(); ++v) {
    const Umbrella& u = umbrellas[v];
    for (int k = 0; k < u.count; ++k) {
      faces += std::size_t(u.spans(k));
      if (u.count == 1) continue;
      const double gap =
          ccw_angle(ground.surfaces[v].normal, ground.points[u.ribs[std::size_t(k)]] - ground.points[v],
                    ground.points[u.next(k)] - ground.points[v]);
      EXPECT_GE(gap, apart - kDirection);
    }
  }
  EXPECT_GT(faces, 4 * umbrellas.size()) << "most umbrellas are open all around";
}

TEST_P(UmbrellasOfShape, TheUnitDoesNotMatter) {
  Positions points = test::random_points(GetParam(), 1000, 2);
  const std::vector<Umbrella> here = umbrellas_over(TestGround(points));
  for (auto& p : points) p *= 0x1p-20;
  const std::vector<Umbrella> there = umbrellas_over(TestGround(points));
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t v = 0; v < here.size(); ++v) {
    ASSERT_EQ(here[v].count, there[v].count);
    EXPECT_EQ(here[v].faces, there[v].faces);
    EXPECT_TRUE(
        std::equal(here[v].ribs.begin(), here[v].ribs.begin() + here[v].count, there[v].ribs.begin()));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, UmbrellasOfShape, testing::ValuesIn(test::clean_shapes()),
                         test::NameOfShape());

class UmbrellasOfAwkward : public testing::TestWithParam<test::AwkwardCloud> {};

TEST_P(UmbrellasOfAwkward, AreSound) {
  const TestGround ground(GetParam().points);
  const std::vector<Umbrella> umbrellas = umbrellas_over(ground);
  ASSERT_EQ(umbrellas.size(), ground.points.size());
  for (Index v = 0; v < umbrellas.size(); ++v) {
    const Umbrella& u = umbrellas[v];
    const std::set<Index> ribs(u.ribs.begin(), u.ribs.begin() + u.count);
    EXPECT_EQ(ribs.size(), std::size_t(u.count));
    EXPECT_EQ(ribs.count(v), 0u);
    for (const Index rib : ribs) EXPECT_LT(rib, ground.points.size());
  }
}

INSTANTIATE_TEST_SUITE_P(Clouds, UmbrellasOfAwkward, testing::ValuesIn(test::awkward_clouds(700)),
                         test::name_of_cloud);

TEST(Umbrella, OfAHexagonalGridHasSixRibsAndSixFacesToTheNearest) {
  Positions points;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) points.emplace_back(i + 0.5 * (j % 2), std::sqrt(0.75) * j, 0);
  const TestGround ground(points);
  const std::vector<Umbrella> umbrellas = umbrellas_over(ground);
  for (int i = 3; i < 17; ++i)
    for (int j = 3; j < 17; ++j) {
      const Umbrella& u = umbrellas[std::size_t(20 * i + j)];
      ASSERT_EQ(int(u.count), 6);
      EXPECT_EQ(u.faces, 0x3f);
      for (int k = 0; k < 6; ++k)
        EXPECT_NEAR((points[u.ribs[std::size_t(k)]] - points[std::size_t(20 * i + j)]).norm(), 1, 1e-12);
    }
}

TEST(Umbrella, AtTheRimOfASheetIsNotClosed) {
  Positions points;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) points.emplace_back(i, j, 0);
  const std::vector<Umbrella> umbrellas = umbrellas_over(TestGround(points));
  for (int i = 0; i < 12; ++i) {
    const Umbrella& u = umbrellas[std::size_t(12 * i)];
    int faces = 0;
    for (int k = 0; k < u.count; ++k) faces += int(u.spans(k));
    EXPECT_GT(faces, 0) << i;
    EXPECT_LT(faces, int(u.count)) << "no face reaches around the outside";
  }
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
