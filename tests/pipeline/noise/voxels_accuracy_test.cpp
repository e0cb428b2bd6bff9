/// What `denoise` makes of the centres of voxels that noisy points are in.
#include <random>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <rfsmooth/denoise.h>

#include "tests/pipeline/noise/noisy_sphere.h"
#include "tests/pipeline/noise/voxel_centres.h"
#include "tests/support/meshes.h"

namespace rfsmooth {
namespace {

using noisy::centres;
using noisy::denoise;
using noisy::kVoxel;
using noisy::Voxels;

/// Those that many noisy points of the unit sphere are in. \param noise of a voxel
Voxels of_sphere(double noise) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  Voxels voxels;
  for (int i = 0; i < 100000; ++i) {
    Eigen::Vector3d p = Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
    p *= 1 + noise * kVoxel * normal(engine);
    const Eigen::Vector3d at = (p / kVoxel).array().floor();
    voxels.insert({int(at.x()), int(at.y()), int(at.z())});
  }
  return voxels;
}

class NoisyVoxels : public ::testing::TestWithParam<double> {};

// Two and three voxels lie one behind the other everywhere, as if there were two sheets.
TEST_P(NoisyVoxels, BecomeTheSurface) {
  Positions points = centres(of_sphere(GetParam()));
  ASSERT_GT(points.size(), 3000u);
  const double raw = support::rms_off_unit_sphere(points);
  const DenoiseReport report = denoise(points);
  EXPECT_TRUE(report.measured.on_grid);
  EXPECT_NEAR(report.measured.step, kVoxel, 1e-9);
  EXPECT_LT(support::rms_off_unit_sphere(points), 0.2 * raw);
}

INSTANTIATE_TEST_SUITE_P(Noise, NoisyVoxels, ::testing::Values(0, 0.05, 0.1, 0.15, 0.25, 0.4));

}  // namespace
}  // namespace rfsmooth
