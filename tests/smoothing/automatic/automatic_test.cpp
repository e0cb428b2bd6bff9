#include "smoothing/automatic/automatic.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/patches/patches.h"
#include "smoothing/automatic/patches/thinning.h"
#include "smoothing/automatic/stranded.h"
#include "tests/support/meshes.h"
#include "tests/support/near.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

double spacing(const Positions& points) {
  const rfs_mesh::SpatialIndex index(points, {});
  const auto near = index.nearest(1, {});
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += (points[near[i][0]] - points[i]).norm();
  return sum / double(points.size());
}

Mesh noisy_sphere(double share, double& sigma) {
  Mesh mesh = support::icosphere(4);
  sigma = share * spacing(mesh.positions);
  support::add_noise(mesh, sigma, 11);
  return mesh;
}

/// The same noise everywhere.
rfs_mesh::NoiseField even(double sigma, std::size_t n) {
  rfs_mesh::NoiseField noise;
  noise.sigma = sigma;
  noise.local.assign(n, sigma);
  return noise;
}

Positions smoothed(Mesh mesh, const rfs_mesh::NoiseField& noise, AutomaticReport& report) {
  rfs_mesh::NeighborTable near;
  return automatic_smoothing(mesh, true, noise, spacing(mesh.positions), report, near, {});
}

Positions smoothed(const Mesh& mesh, double sigma, AutomaticReport& report) {
  return smoothed(mesh, even(sigma, mesh.positions.size()), report);
}

std::vector<Index> all(std::size_t n) {
  std::vector<Index> indices(n);
  std::iota(indices.begin(), indices.end(), Index{0});
  return indices;
}

TEST(Automatic, LeavesATenthOfTheErrorOfANoisySphereAndKnowsWhatIsLeft) {
  for (const double share : {0.2, 0.5, 1.0}) {
    double sigma = 0;
    const Mesh mesh = noisy_sphere(share, sigma);
    AutomaticReport report;
    const Positions smooth = smoothed(mesh, sigma, report);
    const double left = support::rms_off_unit_sphere(smooth);
    EXPECT_LT(left, 0.33 * support::rms_off_unit_sphere(mesh.positions)) << share;  // of the square: a tenth
    EXPECT_LT(report.left, 0.5 * sigma) << share;
    EXPECT_GT(report.guide_strength, 0);
  }
}

TEST(Automatic, WhatIsLeftIsNearTheTruthAndStraysAreNotPartOfIt) {
  double sigma = 0;
  Mesh mesh = noisy_sphere(0.5, sigma);
  AutomaticReport report;
  const double truth = support::rms_off_unit_sphere(smoothed(mesh, sigma, report));
  const double left = report.left;
  EXPECT_GT(left, 0.7 * truth);
  EXPECT_LT(left, 1.5 * truth);
  // One point in five hundred thirty sigma off.
  for (std::size_t i = 0; i < mesh.positions.size(); i += 500) mesh.positions[i] *= 1 + 30 * sigma;
  const Positions smooth = smoothed(mesh, sigma, report);
  Positions others;
  for (std::size_t i = 0; i < smooth.size(); ++i)
    if (i % 500 != 0) others.push_back(smooth[i]);
  EXPECT_LT(report.left, 1.5 * support::rms_off_unit_sphere(others));
}

TEST(Automatic, NoiseThatVariesIsSmoothedAwayWhereItIsLoud) {
  // Four times the noise on one half of a sphere: with one figure for both it would stay, taken for shape.
  Mesh mesh = support::icosphere(5), noise = mesh;
  const double quiet = 0.15 * spacing(mesh.positions);
  support::add_noise(noise, quiet, 5);
  rfs_mesh::NoiseField field = even(quiet, mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const bool loud = mesh.positions[i].z() > 0;
    mesh.positions[i] += (loud ? 4 : 1) * (noise.positions[i] - mesh.positions[i]);
    if (loud) field.local[i] *= 4;
  }
  AutomaticReport report;
  const auto loud_half = [&](const Positions& points) {
    Positions half;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (field.local[i] > quiet) half.push_back(points[i]);
    return support::rms_off_unit_sphere(half);
  };
  const double with_field = loud_half(smoothed(mesh, field, report));
  EXPECT_LT(with_field, 0.3 * loud_half(mesh.positions));
  EXPECT_LT(with_field, 0.7 * loud_half(smoothed(mesh, quiet, report)));
}

TEST(Automatic, NoNoiseIsTheIdentity) {
  const Mesh mesh = support::icosphere(4);
  AutomaticReport report;
  EXPECT_EQ(smoothed(mesh, 0, report), mesh.positions);
  EXPECT_EQ(smoothed(mesh, 0.04 * spacing(mesh.positions), report), mesh.positions);
}

TEST(Automatic, NoPointMovesFartherThanFiveSigma) {
  double sigma = 0;
  Mesh mesh = noisy_sphere(0.5, sigma);
  mesh.positions[100] *= 1.5;  // a stray
  AutomaticReport report;
  const Positions smooth = smoothed(mesh, sigma, report);
  for (std::size_t i = 0; i < smooth.size(); ++i)
    EXPECT_LE((smooth[i] - mesh.positions[i]).norm(), 5 * sigma * (1 + 1e-12));
}

TEST(Patches, PredictAQuadricExactlyWhateverTheSharesOfThePointsAre) {
  Positions guide, data;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) {
      const double x = i + 0.3 * std::sin(7.0 * j), y = j + 0.3 * std::cos(5.0 * i);
      guide.emplace_back(x, y, 0);
      data.emplace_back(x, y, 0.01 * x * x - 0.02 * x * y + 0.3 * y - 1);
    }
  const HeightField field(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data, {});
  for (const std::size_t m : {16, 100}) {
    std::vector<Index> seeds = thin(guide, all(guide.size()), {});
    Patches::Memory memory;
    const Patches patches(field, m, seeds, std::vector<double>(guide.size(), 1), memory, {});
    const Prediction p = patches.predict({});
    for (std::size_t i = 0; i < guide.size(); ++i) {
      ASSERT_TRUE(p.covered[i]);
      EXPECT_NEAR(double(p.height[i]), field.height(i), 1e-4) << m;
      EXPECT_GT(p.own[i], 0);
      EXPECT_LT(p.own[i], 1);
    }
  }
}

TEST(Patches, OwnIsTheDerivativeOfAPredictionByThePointsHeight) {
  Positions guide, data;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      guide.emplace_back(i + 0.2 * std::sin(3.0 * j), j + 0.2 * std::cos(4.0 * i), 0);
      data.push_back(guide.back() + Eigen::Vector3d(0, 0, 0.01 * std::sin(1.7 * i * j)));
    }
  // Noise so large that no patch has residuals above it: the weights of the patches stay as they are.
  const std::vector<Index> seeds = thin(guide, all(guide.size()), {});
  const std::size_t i = 207;
  const double step = 0.5;
  const std::vector<double> sigma(guide.size(), 10);
  const HeightField field(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data, {});
  Patches::Memory memory;
  const Prediction before = Patches(field, 24, seeds, sigma, memory, {}).predict({});
  data[i].z() += step;
  const HeightField lifted(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data, {});
  const Prediction after = Patches(lifted, 24, seeds, sigma, memory, {}).predict({});
  const double side = field.normal(i).z();
  EXPECT_NEAR(double(after.height[i] - before.height[i]) / (side * step), double(before.own[i]), 1e-4);
}

TEST(Patches, MeanOfAConstantIsTheConstant) {
  const Mesh mesh = support::icosphere(3);
  const HeightField field(mesh.positions, rfs_mesh::KdTree(mesh.positions, {}),
                          support::near_on(mesh.positions), mesh.positions, {});
  const std::vector<float> seven(field.size(), 7);
  Patches::Memory memory;
  const Patches patches(field, 40, thin(mesh.positions, all(field.size()), {}),
                        std::vector<double>(field.size(), 1), memory, {});
  for (const float v : patches.mean(seven, {})) EXPECT_NEAR(v, 7, 1e-5);
  for (const float v : field.local_mean(seven, {})) EXPECT_NEAR(v, 7, 1e-5);
}

TEST(Thinning, KeepsAnIndependentSetThatEveryPointIsNearTo) {
  const Mesh mesh = [] {
    Mesh m = support::icosphere(4);
    support::add_noise(m, 0.01, 2);
    return m;
  }();
  const std::size_t n = mesh.positions.size();
  const std::vector<Index> kept = thin(mesh.positions, all(n), {});
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_GT(kept.size(), n / 5);
  EXPECT_LT(kept.size(), n / 2);
  const std::set<Index> in(kept.begin(), kept.end());
  const rfs_mesh::SpatialIndex index(mesh.positions, {});
  const auto near = index.nearest(3, {});
  for (const Index k : kept)
    for (const Index j : near[k]) EXPECT_EQ(in.count(j), 0u);
  // By the neighbours of all: the same, first of all points, then of what was kept.
  const auto wide = index.nearest(32, {});
  EXPECT_EQ(thin_all(index, near, {}), kept);
  EXPECT_EQ(thin_dense(index, wide, kept, {}), thin(mesh.positions, kept, {}));
  EXPECT_EQ(thin_dense(index, near, kept, {}), thin(mesh.positions, kept, {})) << "too few in the rows";
  EXPECT_TRUE(thin(mesh.positions, {}, {}).empty());
  EXPECT_EQ(thin(mesh.positions, {4}, {}), std::vector<Index>{4});
}

/// land_stranded, and whether the table still holds every point's nearest, nearer ones first.
std::size_t land(const Mesh& mesh, double most, Positions& guide) {
  const rfs_mesh::NeighborTable before = rfs_mesh::SpatialIndex(guide, {}).nearest(32, {});
  const Positions start = guide;
  const auto [found, near, tree] = land_stranded(mesh, most, guide, {});
  const rfs_mesh::SpatialIndex index(guide, {});
  const rfs_mesh::NeighborTable exact = index.nearest(32, {});
  for (std::size_t i = 0; i < guide.size(); ++i) {
    const auto moved = [&](Index j) { return guide[j] != start[j]; };
    const bool touched = moved(Index(i)) || std::any_of(before[i].begin(), before[i].end(), moved);
    for (std::size_t k = 0; k < 32; ++k) EXPECT_EQ(near[i][k], touched ? exact[i][k] : before[i][k]) << i;
  }
  return found;
}

TEST(Stranded, IslandsBesideTheSurfaceAreLanded) {
  Mesh mesh = support::icosphere(5);
  for (std::size_t i = 0; i < 2000; i += 100) mesh.positions[i] *= 1.1;
  Positions guide = mesh.positions;
  EXPECT_GE(land(mesh, 0.5, guide), 20u);
  for (std::size_t i = 0; i < 2000; i += 100) EXPECT_NEAR(guide[i].norm(), 1, 0.01);
  guide = mesh.positions;
  land(mesh, 0.05, guide);
  for (std::size_t i = 0; i < 2000; i += 100) EXPECT_EQ(guide[i], mesh.positions[i]) << "too far: a stray";
}

TEST(Stranded, DenseIslandsHalfWayBetweenTwoSheetsAreLandedOnOneOfThem) {
  // Two sheets sixteen apart, hexagonal, and between them clusters of fifteen points, denser than the sheets.
  Mesh mesh;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < 60; ++i)
      for (int j = 0; j < 60; ++j) mesh.positions.emplace_back(i + 0.5 * (j % 2), 0.866 * j, 16 * side);
  const std::size_t sheets = mesh.positions.size();
  for (int k = 0; k < 9; ++k)
    for (int m = 0; m < 15; ++m)
      mesh.positions.emplace_back(15 + 15 * (k % 3) + 0.4 * (m % 5), 13 + 13 * (k / 3) + 0.4 * (m / 5), 8.4);
  const std::size_t n = mesh.positions.size();
  std::vector<Edge> ring;
  for (Index i = 0; i < Index(n); ++i) ring.push_back({i, Index((i + 1) % n)});
  mesh.one_ring = rfsmooth::make_adjacency(n, ring, {});
  Positions guide = mesh.positions;
  land(mesh, 20, guide);
  for (std::size_t i = sheets; i < n; ++i)
    EXPECT_LT(std::min(std::abs(guide[i].z()), std::abs(guide[i].z() - 16)), 0.01) << i;
  for (std::size_t i = 0; i < sheets; ++i) EXPECT_NEAR(guide[i].z(), i < sheets / 2 ? 0 : 16, 0.01) << i;
}

}  // namespace
