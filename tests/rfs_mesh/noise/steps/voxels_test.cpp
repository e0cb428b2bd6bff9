#include "rfs_mesh/noise/steps/voxels.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "base/quantile.h"
#include "rfs_mesh/fit/local_surface.h"
#include "tests/support/thinned.h"

using namespace rfsmooth;

namespace {

constexpr double kSize = 0.06;

std::optional<double> find(const Positions& points, int threads = 1) {
  Context context;
  context.threads = threads;
  const rfs_mesh::SpatialIndex index(points, context);
  std::vector<double> nearest = rfs_mesh::nearest_distances(index, context);
  return rfs_mesh::voxel_size(index, quantile(nearest, 0.5), context);
}

/// Five faces of a box, the lid missing, with noise of a fifth of a voxel.
Positions box() {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal(0, 0.2 * kSize);
  Positions points;
  for (int i = 0; i < 100000; ++i) {
    Eigen::Vector3d p(uniform(engine), uniform(engine), uniform(engine));
    const Eigen::Index axis = i % 3;
    p[axis] = (axis == 2 || i % 2 == 0 ? -1 : 1) + normal(engine);
    points.push_back(p);
  }
  return points;
}

TEST(VoxelSize, IsThatOfTheMeansOfVoxels) {
  const Positions points = support::means_of_voxels(box(), kSize);
  const auto size = find(points);
  ASSERT_TRUE(size);
  EXPECT_NEAR(*size, kSize, 0.02 * kSize);
  EXPECT_EQ(size, find(points, 4));
}

TEST(VoxelSize, IsFoundWhereverTheCloudWasMovedAndHoweverLargeItIs) {
  Positions points = support::means_of_voxels(box(), kSize);
  for (Eigen::Vector3d& p : points) p = 1000 * (p + Eigen::Vector3d(0.3, -7.1, 12.7));
  const auto size = find(points);
  ASSERT_TRUE(size);
  EXPECT_NEAR(*size, 1000 * kSize, 20 * kSize);
}

TEST(VoxelSize, IsNotThereWhereNothingWasThinned) {
  EXPECT_FALSE(find(box()));
}

TEST(VoxelSize, IsNotThatOfAGrid) {
  Positions grid;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) grid.emplace_back(0.1 * i, 0.1 * j, std::sin(0.05 * i));
  EXPECT_FALSE(find(grid));
}

TEST(VoxelSize, IsNotAskedOfPairsFarApart) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Positions pairs;
  for (int i = 0; i < 2000; ++i) {
    pairs.emplace_back(uniform(engine), uniform(engine), uniform(engine));
    pairs.push_back(pairs.back() + Eigen::Vector3d(1e-9, 0, 0));
  }
  EXPECT_FALSE(find(pairs));
  EXPECT_FALSE(find(Positions(500, Eigen::Vector3d(1, 2, 3))));
}

}  // namespace
