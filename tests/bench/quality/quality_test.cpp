#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "clouds/shapes/random.h"
#include "clouds/shapes/shapes.h"
#include "tests/bench/quality/data/closest.h"
#include "tests/bench/quality/data/dataset.h"
#include "tests/bench/quality/data/measure.h"

namespace rfsmooth::bench {
namespace {

double squared_to_mesh(const Mesh& mesh, const Eigen::Vector3d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& f : mesh.faces)
    best = std::min(
        best, (closest_on_triangle(p, mesh.positions[f[0]], mesh.positions[f[1]], mesh.positions[f[2]]) - p)
                  .squaredNorm());
  return best;
}

Mesh unit_square() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(ClosestTree, AgreesWithLookingAtEveryTriangle) {
  const auto mesh = clouds::make_wavy_sheet()->mesh(0.2);
  const ClosestTree tree(mesh);
  clouds::Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = 2 * random.normal3();
    const auto hit = tree.nearest(p);
    EXPECT_NEAR(hit.squared, squared_to_mesh(mesh, p), 1e-12);
    EXPECT_NEAR((hit.point - p).squaredNorm(), hit.squared, 1e-12);
  }
}

TEST(ClosestTree, KNearestAgreesWithSorting) {
  clouds::Random random(2);
  Positions points(500);
  for (auto& p : points) p = random.normal3();
  const ClosestTree tree(points);
  const Eigen::Vector3d query = random.normal3();
  std::vector<std::pair<double, Index>> all;
  for (std::size_t i = 0; i < points.size(); ++i)
    all.emplace_back((points[i] - query).squaredNorm(), Index(i));
  std::sort(all.begin(), all.end());
  all.resize(20);
  EXPECT_EQ(tree.k_nearest(query, 20), all);
  EXPECT_EQ(tree.k_nearest(query, 1000).size(), points.size());
  EXPECT_EQ(tree.nearest(points[7]).primitive, 7u);
  EXPECT_NE(tree.nearest(points[7], 7).primitive, 7u);
}

TEST(ClosestTree, ATriangleOfEveryRegion) {
  const Eigen::Vector3d a(0, 0, 0), b(2, 0, 0), c(0, 2, 0);
  EXPECT_EQ(closest_on_triangle({-1, -1, 3}, a, b, c), a);
  EXPECT_EQ(closest_on_triangle({3, -1, 3}, a, b, c), b);
  EXPECT_EQ(closest_on_triangle({-1, 3, 3}, a, b, c), c);
  EXPECT_EQ(closest_on_triangle({1, -1, 0}, a, b, c), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(closest_on_triangle({-1, 1, 0}, a, b, c), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(closest_on_triangle({2, 2, 0}, a, b, c), Eigen::Vector3d(1, 1, 0));
  EXPECT_TRUE(closest_on_triangle({0.5, 0.5, 7}, a, b, c).isApprox(Eigen::Vector3d(0.5, 0.5, 0)));
  EXPECT_EQ(closest_on_triangle({5, 0, 0}, a, a, a), a);
}

TEST(Dataset, NormalisedToTheUnitSphere) {
  const auto sample = make_sample("plate", clouds::make_plate(0.3)->mesh(1), 500);
  Eigen::Vector3d low = sample->clean[0], high = low;
  double radius = 0;
  for (const auto& p : sample->clean) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    radius = std::max(radius, p.norm());
  }
  EXPECT_LT((low + high).norm(), 1e-12);
  EXPECT_NEAR(radius, 1, 1e-12);
}

TEST(Dataset, NoiseHasTheStatedSizeAndDirection) {
  const auto sample = make_sample("sphere", clouds::make_sphere()->mesh(0.05), 2000);
  const Case gaussian = make_case(sample, {NoiseKind::gaussian, 0.02, 0.01});
  const Case ray = make_case(sample, {NoiseKind::ray, 0.02, 0});
  ASSERT_EQ(gaussian.noisy.size(), 2020u);
  ASSERT_EQ(ray.noisy.size(), 2000u);
  double isotropic = 0, along = 0;
  for (std::size_t i = 0; i < 2000; ++i) {
    isotropic += (gaussian.noisy[i] - sample->clean[i]).squaredNorm() / 3;
    along += (ray.noisy[i] - sample->clean[i]).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(isotropic / 2000), 0.02, 0.001);
  EXPECT_NEAR(std::sqrt(along / 2000), 0.02, 0.001);
  EXPECT_FALSE(gaussian.planted(1999));
  EXPECT_TRUE(gaussian.planted(2000));
  EXPECT_EQ(gaussian.noisy, make_case(sample, {NoiseKind::gaussian, 0.02, 0.01}).noisy);
  EXPECT_NE(gaussian.noisy, make_case(sample, {NoiseKind::gaussian, 0.02, 0.01}, 2).noisy);
  EXPECT_EQ(make_case(sample, {}).noisy, sample->clean);
}

TEST(Measure, ACleanCloudHasNoErrorAndALiftedOneItsLift) {
  const auto sample = make_sample("square", unit_square(), 800);
  const Truth truth(sample);
  const auto clean = truth.measure(sample->clean, {}, {});
  EXPECT_EQ(clean.chamfer, 0);
  EXPECT_LT(clean.p2s, 1e-24);
  EXPECT_LT(clean.normal, 1e-3);
  EXPECT_EQ(clean.points, 800u);
  EXPECT_EQ(clean.edge_points, 0u);
  const double lift = 1e-3;  // far below the spacing: everybody's nearest clean point is its own
  Positions lifted = sample->clean;
  for (auto& p : lifted) p[2] += lift;
  const auto moved = truth.measure(lifted, {}, {});
  EXPECT_NEAR(moved.p2s, lift * lift, 1e-9 * lift);
  EXPECT_NEAR(moved.p2s_max, lift, 1e-9);
  EXPECT_NEAR(moved.chamfer, 2 * lift * lift, 1e-9 * lift);
  EXPECT_NEAR(moved.evenness, clean.evenness, 1e-9);
}

TEST(Measure, EdgesOfABoxAreItsEdges) {
  const auto sample = make_sample("cube", clouds::make_cube()->mesh(2), 2000);
  const Truth truth(sample);
  const auto at = truth.measure(sample->clean, {}, {});
  // Two strips of two spacings along each of twelve edges; the facets' diagonals are no edges.
  const double edge = sample->clean[0].cwiseAbs().maxCoeff() * 2;  // every point lies on a face
  const double inner = edge - 4 * sample->spacing;
  const double share = 1 - inner * inner / (edge * edge);
  EXPECT_NEAR(double(at.edge_points) / 2000, share, 0.02);
}

TEST(Measure, PlantedPointsAndUnknownRowsAreHandled) {
  const auto sample = make_sample("cube", clouds::make_cube()->mesh(2), 400);
  const Truth truth(sample);
  const auto direct = truth.measure(sample->clean, {}, {});
  Positions shuffled(sample->clean.rbegin(), sample->clean.rend());
  std::vector<Index> source(400);
  for (Index i = 0; i < 400; ++i) source[i] = 399 - i;
  shuffled.emplace_back(5, 5, 5);  // a planted outlier, row 400
  source.push_back(400);
  const auto again = truth.measure(shuffled, source, {});
  EXPECT_EQ(again.points, 400u);
  EXPECT_EQ(again.edge_points, direct.edge_points);
  EXPECT_EQ(again.chamfer, 0);
  source.assign(401, kNone);
  EXPECT_GT(truth.measure(shuffled, source, {}).p2s, 0.01);
}

}  // namespace
}  // namespace rfsmooth::bench
