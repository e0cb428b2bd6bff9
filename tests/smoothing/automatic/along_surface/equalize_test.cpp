#include "smoothing/automatic/along_surface/equalize.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "rfs_mesh/search/neighbors.h"
#include "tests/support/shapes.h"

using namespace rfsmooth;
using smoothing::equalize;

namespace {

/// Coefficient of variation of the distances to the nearest neighbour.
double unevenness(const Positions& points) {
  const rfs_mesh::SpatialIndex index(points, {});
  const auto near = index.nearest(1, {});
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double d = (points[near[i][0]] - points[i]).norm();
    sum += d;
    squares += d * d;
  }
  const double mean = sum / double(points.size());
  return std::sqrt(squares / double(points.size()) - mean * mean) / mean;
}

Positions random_sphere(std::size_t n) {
  std::mt19937_64 engine(3);
  Positions points;
  for (std::size_t i = 0; i < n; ++i) points.push_back(test::unit_sphere().sample(engine));
  return points;
}

rfs_mesh::NeighborTable near(const Positions& points) {
  return rfs_mesh::SpatialIndex(points, {}).nearest(32, {});
}

rfs_mesh::NoiseField noise_of(double figure, std::vector<double> local, double spacing = 1) {
  rfs_mesh::NoiseField noise;
  noise.spacing = spacing;
  noise.sigma = figure;
  noise.local = std::move(local);
  return noise;
}

/// Of points that nothing has smoothed: they are where they were before.
smoothing::Equalized spread(Positions& points, double sigma, double spacing, const Context& context) {
  const Positions before = points;
  return equalize(points, before, noise_of(sigma, std::vector<double>(points.size(), sigma), spacing),
                  near(points), context);
}

TEST(Equalize, EvensAClumpedSphereAndStaysOnIt) {
  Positions points = random_sphere(4000);
  const Positions before = points;
  const double spacing = std::sqrt(4 * M_PI / 4000), moved = spread(points, 1, 1, {}).rms;
  EXPECT_LT(unevenness(points), 0.7 * unevenness(before));
  EXPECT_GT(moved, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points[i].norm(), 1, 0.02 * spacing);
    EXPECT_LT((points[i] - before[i]).norm(), 1.2 * spacing)
        << "half the distance on a hexagonal grid, locally";
  }
}

TEST(Equalize, NoPointMovesFartherThanAsked) {
  Positions points = random_sphere(2000);
  const Positions before = points;
  spread(points, 0.001 / 0.7, 1, {});
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((points[i] - before[i]).norm(), 0.0011);
  points = before;
  EXPECT_EQ(spread(points, 0, 1, {}).largest, 0);
  EXPECT_EQ(points, before);
}

TEST(Equalize, ARegularGridAndItsRimStayWhereTheyAre) {
  Positions points;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) points.emplace_back(i, j, 0);
  const Positions before = points;
  spread(points, 1, 1, {});
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((points[i] - before[i]).norm(), 0.05) << i;
}

TEST(Equalize, TheRimOfAnOpenSheetStays) {
  std::mt19937_64 engine(8);
  std::uniform_real_distribution<double> uniform(0, 30);
  Positions points;
  for (int i = 0; i < 900; ++i) points.emplace_back(uniform(engine), uniform(engine), 0);
  spread(points, 1, 1, {});
  for (const auto& p : points) {
    EXPECT_GT(p.minCoeff(), -0.3);
    EXPECT_LT(p.maxCoeff(), 30.3);
    EXPECT_NEAR(p.z(), 0, 1e-9);
  }
}

TEST(Equalize, TheRimDoesNotMoveInward) {
  for (const double noise : {0.3, 1.0}) {
    Positions points = clouds::sample(*clouds::make_wavy_sheet(), 3000, 1);
    const double spacing = clouds::mean_spacing(points);
    clouds::add_noise(points, 0.2 * noise * spacing, 2);
    const Positions before = points;
    spread(points, noise * spacing, spacing, {});
    double inward = 0;
    std::size_t rim = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double from_middle = before[i].head<2>().lpNorm<Eigen::Infinity>();
      if (from_middle < 1 - spacing / 2) continue;
      inward += from_middle - points[i].head<2>().lpNorm<Eigen::Infinity>();
      ++rim;
    }
    EXPECT_GT(rim, 50u);
    EXPECT_LT(inward / double(rim), 0.02 * spacing) << noise;
  }
}

TEST(Equalize, SharpEdgesStayWhereTheyAre) {
  const auto shape = clouds::make_cube();
  Positions points = clouds::sample(*shape, 4000, 1);
  const double spacing = clouds::mean_spacing(points);
  const Positions before = points;
  spread(points, spacing, spacing, {});
  double away = 0, off = 0;  // points slide along an edge, but not away from it nor off the faces
  std::size_t edge = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    off += std::pow(shape->signed_distance(points[i]), 2);
    if (shape->edge_distance(before[i]) > spacing / 2) continue;
    away += shape->edge_distance(points[i]) - shape->edge_distance(before[i]);
    ++edge;
  }
  EXPECT_GT(edge, 100u);
  EXPECT_LT(std::abs(away) / double(edge), 0.05 * spacing);
  EXPECT_LT(std::sqrt(off / double(points.size())), 0.05 * spacing);
}

// At noise of a quarter of a spacing three quarters of the way back; at four spacings next to nothing.
TEST(Equalize, WhatWasMovedSidewaysGoesBackWhereNoiseIsSmall) {
  Positions before;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) before.emplace_back(i, j, 0);
  const Eigen::Vector3d aside(0.2, -0.1, 0);
  for (const auto& [noise, share] : {std::pair{0.25, 0.75}, {4.0, 0.019}}) {
    Positions points = before;
    for (auto& p : points) p += aside;
    equalize(points, before, noise_of(noise, std::vector<double>(points.size(), noise)), near(points), {});
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LT((points[i] - before[i] - (1 - share) * aside).norm(), 0.01) << noise;
  }
}

// They went with a fairing that was made for the others, and go back all the way.
TEST(Equalize, CalmPointsAmongLoudOnesGoBackAllTheWay) {
  Positions before;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) before.emplace_back(i, j, 0);
  const Eigen::Vector3d aside(0.2, -0.1, 0);
  Positions points = before;
  for (auto& p : points) p += aside;
  std::vector<double> sigma(points.size(), 0.3);
  for (std::size_t i = 0; i < sigma.size() / 2; ++i) sigma[i] = 0.001;
  equalize(points, before, noise_of(0.3, sigma), near(points), {});
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR((points[i] - before[i]).norm(), (2 * i < points.size() ? 0 : 0.25) * aside.norm(), 0.01) << i;
}

TEST(Equalize, PointsWithoutNoiseStayAmongThoseWithSome) {
  Positions points = random_sphere(4000);
  const Positions before = points;
  std::vector<double> sigma(points.size(), 0.0);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].x() > 0) sigma[i] = 1;
  EXPECT_GT(equalize(points, before, noise_of(1, sigma), near(points), {}).rms, 0);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (before[i].x() <= 0) {
      ASSERT_LT((points[i] - before[i]).norm(), 1e-6);
    }
}

TEST(Equalize, AnEvenCloudStaysAsItIs) {
  const auto shape = clouds::make_sphere();
  const Positions before = clouds::sample(*shape, 4000, 1);
  const double spacing = clouds::mean_spacing(before);
  Positions points = before;
  EXPECT_LT(spread(points, 0.1 * spacing, spacing, {}).rms, 0.02 * spacing) << "little noise, little to undo";
  points = before;
  spread(points, 2 * spacing, spacing, {});
  EXPECT_LE(unevenness(points), unevenness(before));
}

TEST(Equalize, NoPointMovesMoreThanHalfASpacing) {
  Positions points = random_sphere(3000);
  const Positions before = points;
  const double spacing = clouds::mean_spacing(points);
  const auto moved = spread(points, 10, spacing, {});
  EXPECT_LE(moved.largest, 0.5 * spacing * (1 + 1e-12));
  EXPECT_GT(moved.largest, 0.49 * spacing);
  EXPECT_LE(moved.rms, moved.largest);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((points[i] - before[i]).norm(), 0.55 * spacing);
}

TEST(Equalize, IsTheSameForAnyNumberOfThreadsAndTurnsWithTheCloud) {
  Positions points = random_sphere(2000), turned = points, again = points;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (auto& p : turned) p = turn * p;
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  spread(points, 1, 1, one);
  spread(again, 1, 1, four);
  EXPECT_EQ(points, again);
  spread(turned, 1, 1, four);
  for (std::size_t i = 0; i < points.size(); ++i)  // moves are in single precision
    EXPECT_LT((turned[i] - turn * points[i]).norm(), 1e-6);
}

TEST(Equalize, TinyCloudsStay) {
  for (const std::size_t n : {0, 1, 5, 24}) {
    Positions points = random_sphere(n);
    const Positions before = points;
    spread(points, 1, 1, {});
    EXPECT_EQ(points, before);
  }
  Positions same(100, Eigen::Vector3d(1, 2, 3));
  spread(same, 1, 1, {});
  for (const auto& p : same) EXPECT_EQ(p, Eigen::Vector3d(1, 2, 3));
}

}  // namespace
