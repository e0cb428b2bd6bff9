/// What `denoise` makes of clouds of voxels: of their centres, turned as a registered scan may be, and of the
/// means of the points in them.
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include <rfsmooth/denoise.h>

#include "tests/pipeline/noise/noisy_sphere.h"
#include "tests/pipeline/noise/voxel_centres.h"
#include "tests/support/thinned.h"

namespace rfsmooth {
namespace {

using noisy::centres;
using noisy::denoise;
using noisy::kVoxel;
using noisy::Voxels;

// Of whole voxels, 40 along each edge.
TEST(Voxels, OfAnExactBoxStay) {
  constexpr int kEdge = 40;
  Voxels box;
  for (int i = 0; i <= kEdge; ++i)
    for (int j = 0; j <= kEdge; ++j)
      for (const int k : {0, kEdge}) box.insert({{i, j, k}, {i, k, j}, {k, i, j}});
  Positions points = centres(box);
  const Positions before = points;
  denoise(points);
  EXPECT_TRUE(points == before);
}

// Treads and risers of ten voxels.
TEST(Voxels, OfExactStairsStay) {
  constexpr int kTread = 10, kStairs = 6, kWidth = 80;
  Voxels stairs;
  for (int stair = 0; stair < kStairs; ++stair)
    for (int along = 0; along <= kTread; ++along)
      for (int across = 0; across < kWidth; ++across) {
        const int front = stair * kTread, top = (stair + 1) * kTread;
        stairs.insert({front, across, front + along});  // as high as it is far
        stairs.insert({front + along, across, top});
      }
  Positions points = centres(stairs);
  const Positions before = points;
  denoise(points);
  EXPECT_TRUE(points == before);
}

/// A floor and two walls of noisy points, 40 voxels long and half as high. \param phase where in their voxels
/// they are
Positions room(double noise, double phase) {
  constexpr double kLength = 40 * kVoxel;
  const double at = phase * kVoxel;
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal(0, noise * kVoxel);
  std::uniform_real_distribution<double> uniform(at, kLength);
  Positions points;
  for (int i = 0; i < 200000; ++i) {
    const double u = uniform(engine), v = uniform(engine), off = at + normal(engine);
    const double up = at + (v - at) / 2;
    points.push_back(i % 2 == 0   ? Eigen::Vector3d(u, v, off)
                     : i % 4 == 1 ? Eigen::Vector3d(off, u, up)
                                  : Eigen::Vector3d(u, off, up));
  }
  return points;
}

/// From the nearest of the floor and the walls.
double rms_off_room(const Positions& points, double phase) {
  double sum = 0;
  for (const Eigen::Vector3d& p : points) sum += std::pow((p.array() - phase * kVoxel).abs().minCoeff(), 2);
  return std::sqrt(sum / double(points.size()));
}

class Means : public ::testing::TestWithParam<std::pair<double, double>> {};

// Floors that lie across two voxels are two layers, each far calmer than the noise was.
TEST_P(Means, OfFloorsAndWallsBecomeOneSurface) {
  const auto [noise, phase] = GetParam();
  Positions points = support::means_of_voxels(room(noise, phase), kVoxel);
  ASSERT_GT(points.size(), 3000u);
  const double raw = rms_off_room(points, phase);
  denoise(points);
  EXPECT_LT(rms_off_room(points, phase), 0.65 * raw);
}

INSTANTIATE_TEST_SUITE_P(NoiseAndPhase, Means,
                         ::testing::Values(std::pair(0.2, 0.1), std::pair(0.3, 0.1), std::pair(0.2, 0.3),
                                           std::pair(0.3, 0.3), std::pair(0.3, 0.5)));

// Both sides of a plate lie along the voxels, the farther ones a voxel and a half apart.
TEST(Voxels, MeansOfAPlateKeepItsThickness) {
  constexpr double kThick = 1.5 * kVoxel, kAt = 0.4 * kVoxel;
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal(0, 0.05 * kVoxel);
  std::uniform_real_distribution<double> uniform(0, 60 * kVoxel);
  Positions all;
  for (int i = 0; i < 100000; ++i)
    all.emplace_back(uniform(engine), uniform(engine), kAt + (i % 2) * kThick + normal(engine));
  Positions points = support::means_of_voxels(all, kVoxel);
  denoise(points);
  double most = 0;
  for (const Eigen::Vector3d& p : points) {
    const double z = p.z() - kAt;
    most = std::max(most, std::min(std::abs(z), std::abs(z - kThick)));
  }
  EXPECT_LT(most, 0.3 * kVoxel);
}

}  // namespace
}  // namespace rfsmooth
