/// How the rough meshes of clean and of noisy clouds turn out.
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "rfs_mesh/connect/connect.h"
#include "tests/rfs_mesh/connect/connected.h"
#include "tests/support/connection.h"
#include "tests/support/shapes.h"

using namespace rfsmooth;

namespace {

using test::connected;
using test::share_in_common;

class ProportionsOfThePaper : public testing::TestWithParam<test::Shape> {};

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

TEST_P(ProportionsOfThePaper, OnRandomPoints) {
  expect_papers_proportions(GetParam(), test::random_points(GetParam(), 8000, 3));
}

TEST_P(ProportionsOfThePaper, OnPoissonDiskPoints) {
  expect_papers_proportions(GetParam(), test::poisson_points(GetParam(), 8000, 3));
}

INSTANTIATE_TEST_SUITE_P(Shapes, ProportionsOfThePaper, testing::ValuesIn(test::clean_shapes()),
                         test::NameOfShape());

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

}  // namespace
