#include <algorithm>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "rfs_mesh/connect/connect.h"
#include "rfs_mesh/measure.h"
#include "rfs_mesh/noise/noise.h"
#include "tests/support/awkward_clouds.h"
#include "tests/support/connection.h"
#include "tests/support/sanitized.h"
#include "tests/support/shapes.h"
#include "tests/support/threads.h"

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

Connection connected(const Positions& points, int threads = 0) {
  Context context;
  context.threads = threads;
  return connect(points, ConnectOptions{}, context).value();
}

class CleanShape : public testing::TestWithParam<test::Shape> {};

void expect_papers_proportions(const test::Shape& shape, const Positions& points) {
  const Connection c = connected(points);
  test::expect_sound(c, points.size());
  const double n = double(points.size());
  EXPECT_TRUE(test::joins_all(points.size(), c.sdg, c.bridges));
  EXPECT_GE(double(c.sdg.size()), 1.4 * n);
  EXPECT_LE(double(c.sdg.size()), 2.8 * n);
  EXPECT_GE(double(c.mesh.faces.size()), 1.6 * n);
  EXPECT_LE(double(c.mesh.faces.size()), 2.4 * n);
  // A rim costs edges: even a valid triangulation of an open sheet has fewer than three per point.
  EXPECT_GE(double(c.mesh.edge_count()), (shape.name == "plane" ? 2.9 : 3.0) * n);
  EXPECT_LE(double(c.mesh.edge_count()), 5.0 * n);
  EXPECT_LT(double(c.faceless), 0.01 * n);
}

TEST_P(CleanShape, ProportionsOfThePaperOnRandomPoints) {
  expect_papers_proportions(GetParam(), test::random_points(GetParam(), 8000, 3));
}

TEST_P(CleanShape, ProportionsOfThePaperOnPoissonDiskPoints) {
  expect_papers_proportions(GetParam(), test::poisson_points(GetParam(), 8000, 3));
}

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

double share_in_common(const std::vector<Face>& a, const std::vector<Face>& b) {
  const auto sorted = [](std::vector<Face> faces) {
    for (Face& f : faces) std::sort(f.begin(), f.end());
    std::sort(faces.begin(), faces.end());
    return faces;
  };
  const auto x = sorted(a), y = sorted(b);
  std::vector<Face> both;
  std::set_intersection(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(both));
  return double(both.size()) / double(std::max(x.size(), y.size()));
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

Positions with_noise(Positions points, double sigma, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0, sigma);
  for (auto& p : points) {
    const double x = normal(engine), y = normal(engine), z = normal(engine);
    p += Eigen::Vector3d(x, y, z);
  }
  return points;
}

/// Noise in units of sqrt(area / n), and the share of edges that may join points more than three such units
/// apart on the true sphere.
class NoisySphere : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(NoisySphere, MeshStaysASurface) {
  const auto [noise, may_be_long] = GetParam();
  const test::Shape sphere = test::unit_sphere();
  const Positions clean = test::poisson_points(sphere, 6000, 1);
  const double unit = std::sqrt(sphere.area / double(clean.size()));
  const Positions points = with_noise(clean, noise * unit, 2);
  const Connection c = connected(points);
  test::expect_sound(c, points.size());
  EXPECT_NEAR(c.noise.sigma, noise * unit, 0.2 * noise * unit);
  std::size_t long_edges = 0;
  for (Index a = 0; a < points.size(); ++a)
    for (const Index b : c.mesh.one_ring[a])
      long_edges += a < b && (points[a].normalized() - points[b].normalized()).norm() > 3 * unit;
  EXPECT_LT(double(long_edges), may_be_long * double(c.mesh.edge_count()));
  EXPECT_GT(double(c.mesh.faces.size()), 1.5 * double(points.size()));
  EXPECT_LT(double(c.faceless), 0.01 * double(points.size()));
}

TEST_P(NoisySphere, ATurnedCloudKeepsItsFaces) {
  const test::Shape sphere = test::unit_sphere();
  const double unit = std::sqrt(sphere.area / 6000);
  const Positions points = with_noise(test::random_points(sphere, 6000, 3), GetParam().first * unit, 4);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).matrix();
  Positions turned = points;
  for (auto& p : turned) p = turn * p;
  // Wide neighbourhoods are told apart in single precision.
  EXPECT_GT(share_in_common(connected(points).mesh.faces, connected(turned).mesh.faces), 0.95);
}

INSTANTIATE_TEST_SUITE_P(Noise, NoisySphere,
                         testing::Values(std::pair(0.5, 0.01), std::pair(1.0, 0.01), std::pair(2.0, 0.05),
                                         std::pair(3.0, 0.05)));

/// Noise in spacings. At 0.5 it carries a point in 740 past the middle of the plate.
class NoisyThinPlate : public testing::TestWithParam<double> {};

TEST_P(NoisyThinPlate, KeepsItsTwoSides) {
  // Three spacings thick: fewer than 0.1 % of the edges away from the rim join the sides, and few points lose
  // their neighbours for it.
  const double unit = 0.01;
  Positions points;
  for (const bool top : {false, true})
    for (Eigen::Vector3d p : test::poisson_points(test::plane(), 10000, top ? 2 : 1)) {
      p[2] = top ? 3 * unit : 0;
      points.push_back(p);
    }
  const std::size_t bottom = test::poisson_points(test::plane(), 10000, 1).size();
  points = with_noise(points, GetParam() * unit, 3);
  const Connection c = connected(points);
  test::expect_sound(c, points.size());
  EXPECT_TRUE(test::joins_all(points.size(), c.sdg, c.bridges));
  const auto at_rim = [&](Index v) {
    const double x = points[v][0], y = points[v][1];
    return std::min({x, y, 1 - x, 1 - y}) < 6 * unit;
  };
  std::size_t inner = 0, crossing = 0;
  for (Index a = 0; a < points.size(); ++a)
    for (const Index b : c.mesh.one_ring[a]) {
      if (b < a || at_rim(a) || at_rim(b)) continue;
      ++inner;
      crossing += (a < bottom) != (b < bottom);
    }
  EXPECT_GT(inner, points.size());
  EXPECT_LT(double(crossing), 0.001 * double(inner));
  EXPECT_LT(double(c.faceless), 0.015 * double(points.size()));
}

INSTANTIATE_TEST_SUITE_P(Noise, NoisyThinPlate, testing::Values(0.3, 0.5));

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
