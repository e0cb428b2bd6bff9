#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "rfs_mesh/connect/connect.h"
#include "rfs_mesh/noise/noise.h"
#include "tests/rfs_mesh/connect/connected.h"
#include "tests/support/awkward_clouds.h"
#include "tests/support/connection.h"
#include "tests/support/sanitized.h"
#include "tests/support/shapes.h"
#include "tests/support/threads.h"

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

using test::connected;
using test::share_in_common;

class CleanShape : public testing::TestWithParam<test::Shape> {};

TEST_P(CleanShape, SameBytesForAnyNumberOfThreads) {
  const Positions points = test::random_points(GetParam(), test::kSanitized ? 2000 : 4000, 5);
  const Connection one = connected(points, 1);
  for (const int threads : test::several_threads()) {
    const Connection many = connected(points, threads);
    EXPECT_EQ(one.mesh.faces, many.mesh.faces);
    EXPECT_EQ(one.mesh.loose_edges, many.mesh.loose_edges);
    EXPECT_EQ(one.mesh.one_ring.items, many.mesh.one_ring.items);
    EXPECT_EQ(one.sdg, many.sdg);
    EXPECT_EQ(one.noise.sigma, many.noise.sigma);
    EXPECT_EQ(one.noise.spacing, many.noise.spacing);
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_TRUE(one.surfaces[i].shadow == many.surfaces[i].shadow);
  }
}

TEST_P(CleanShape, RigidMotionAndScaleMakeTheSameMesh) {
  const Positions points = test::random_points(GetParam(), 4000, 7);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  Positions moved = points;
  for (auto& p : moved) p = 250 * (turn * p) + Eigen::Vector3d(10, -20, 30);
  const Connection here = connected(points), there = connected(moved);
  EXPECT_NEAR(there.noise.spacing, 250 * here.noise.spacing, 1e-6 * there.noise.spacing);
  // Rounding may decide where two faces or two distances all but tie, and only there.
  EXPECT_GT(share_in_common(here.mesh.faces, there.mesh.faces), 0.99);
  std::vector<Edge> both;
  std::set_intersection(here.sdg.begin(), here.sdg.end(), there.sdg.begin(), there.sdg.end(),
                        std::back_inserter(both));
  EXPECT_GT(double(both.size()), 0.99 * double(here.sdg.size()));
}

INSTANTIATE_TEST_SUITE_P(Shapes, CleanShape, testing::ValuesIn(test::clean_shapes()), test::NameOfShape());

class AwkwardConnection : public testing::TestWithParam<test::AwkwardCloud> {};

TEST_P(AwkwardConnection, IsSound) {
  const Positions& points = GetParam().points;
  const auto c = connect(points, ConnectOptions{}, Context{});
  ASSERT_TRUE(c.ok()) << c.error().message;
  test::expect_sound(c.value(), points.size());
  EXPECT_TRUE(test::joins_all(points.size(), c.value().sdg, c.value().bridges));
}

INSTANTIATE_TEST_SUITE_P(Clouds, AwkwardConnection, testing::ValuesIn(test::awkward_clouds(3000)),
                         test::name_of_cloud);

TEST(Connection, TwoSheetsApartAreJoinedByBridgesOnly) {
  // Two parallel squares three spacings apart: neighbourhood may cross at the rim, nowhere else.
  Positions points;
  for (const double z : {0.0, 0.06})
    for (Eigen::Vector3d p : test::poisson_points(test::plane(), 2500, z == 0 ? 1 : 2)) {
      p[2] = z;
      points.push_back(p);
    }
  const Connection c = connected(points);
  test::expect_sound(c, points.size());
  EXPECT_GT(c.mesh.faces.size(), points.size()) << "each square is a surface";
  EXPECT_EQ(c.bridges.size(), 1u) << "one tie is enough to hold two sheets together";
  for (const Face& f : c.mesh.faces)
    EXPECT_TRUE(points[f[0]][2] == points[f[1]][2] && points[f[1]][2] == points[f[2]][2]);
}

TEST(Connection, StandsOnTheOneMeasureOfNoise) {
  // Depths in steps of three spacings: residuals of narrow neighbourhoods are zero on a terrace, and yet the
  // noise is known, and the tests are made on the shadow.
  constexpr double kStep = 0.03;
  Positions points = test::random_points(test::plane(), 10000, 3);
  for (auto& p : points) p[2] = kStep * std::round((0.4 * p[0] + 0.1 * p[1]) / kStep);
  const SpatialIndex index(points, {});
  const NoiseField noise = rfs_mesh::spread_noise(rfs_mesh::measure_noise(index, {}), points, {});
  ASSERT_GT(noise.sigma, 0.5 * kStep / std::sqrt(12.0));
  const Connection c = connected(points);
  EXPECT_EQ(c.noise.sigma, noise.sigma);
  EXPECT_TRUE(c.on_shadow);
}

TEST(Connection, IsTheSameFromNeighboursThatAreKnown) {
  const Positions points = test::noisy_sphere(3000, 0.02, 1);
  const SpatialIndex index(points, {});
  const Connection from_known = rfs_mesh::connect(index, index.nearest(24, {}), {}, {}, {}).value(),
                   own = connected(points);
  EXPECT_EQ(from_known.mesh.faces, own.mesh.faces);
  EXPECT_EQ(from_known.noise.sigma, own.noise.sigma);
  EXPECT_THROW((void)rfs_mesh::connect(index, index.nearest(23, {}), {}, {}, {}), std::invalid_argument);
}

TEST(Connection, SaysWhatItCannotDo) {
  ConnectOptions options;
  options.umbrella.quality = 2;
  const auto c = connect(Positions(3, Eigen::Vector3d::Zero()), options, Context{});
  ASSERT_FALSE(c.ok());
  EXPECT_EQ(c.error().code, ErrorCode::usage);
}

TEST(Connection, CanBeCancelled) {
  std::atomic<bool> stop{true};
  Context context;
  context.stop = &stop;
  const auto c = connect(test::random_points(test::plane(), 1000, 1), {}, context);
  ASSERT_FALSE(c.ok());
  EXPECT_EQ(c.error().code, ErrorCode::cancelled);
}

}  // namespace
