#include "rfsmooth/smoothing/equalize.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "rfsmooth/rfs_mesh/neighbors.h"

#include "support/shapes.h"

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

TEST(Equalize, EvensAClumpedSphereAndStaysOnIt) {
  Positions points = random_sphere(4000);
  const Positions before = points;
  const double spacing = std::sqrt(4 * M_PI / 4000), moved = equalize(points, 1, {}).rms;
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
  equalize(points, 0.001, {});
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((points[i] - before[i]).norm(), 0.0011);
  points = before;
  EXPECT_EQ(equalize(points, 0, {}).largest, 0);
  EXPECT_EQ(points, before);
}

TEST(Equalize, ARegularGridAndItsRimStayWhereTheyAre) {
  Positions points;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) points.emplace_back(i, j, 0);
  const Positions before = points;
  equalize(points, 1, {});
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((points[i] - before[i]).norm(), 0.05) << i;
}

TEST(Equalize, TheRimOfAnOpenSheetStays) {
  std::mt19937_64 engine(8);
  std::uniform_real_distribution<double> uniform(0, 30);
  Positions points;
  for (int i = 0; i < 900; ++i) points.emplace_back(uniform(engine), uniform(engine), 0);
  equalize(points, 1, {});
  for (const auto& p : points) {
    EXPECT_GT(p.minCoeff(), -0.3);
    EXPECT_LT(p.maxCoeff(), 30.3);
    EXPECT_NEAR(p.z(), 0, 1e-9);
  }
}

TEST(Equalize, TurnsWithTheCloudAndIsTheSameForAnyNumberOfThreads) {
  Positions points = random_sphere(2000), turned = points, again = points;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (auto& p : turned) p = turn * p;
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  equalize(points, 1, one);
  equalize(again, 1, four);
  EXPECT_EQ(points, again);
  equalize(turned, 1, four);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((turned[i] - turn * points[i]).norm(), 1e-8);
}

TEST(Equalize, TinyCloudsStay) {
  for (const std::size_t n : {0, 1, 5, 24}) {
    Positions points = random_sphere(n);
    const Positions before = points;
    equalize(points, 1, {});
    EXPECT_EQ(points, before);
  }
  Positions same(100, Eigen::Vector3d(1, 2, 3));
  equalize(same, 1, {});
  for (const auto& p : same) EXPECT_EQ(p, Eigen::Vector3d(1, 2, 3));
}

}  // namespace
