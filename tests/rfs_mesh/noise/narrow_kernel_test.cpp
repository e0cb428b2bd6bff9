#include "rfs_mesh/noise/narrow_kernel.h"

#include <cmath>
#include <optional>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/rfs_mesh/noise/noisy_solids.h"
#include "tests/support/shapes.h"

using namespace rfsmooth;
using rfs_mesh::noise_in_kernels;
using rfs_mesh::SpatialIndex;

namespace {

using test::kNoiseInSlab;
using test::noisy;
using test::rod;
using test::stack;

constexpr double kMost = 5 * kNoiseInSlab;

std::optional<rfs_mesh::NoiseInKernels> read_from(const Positions& points, double most = kMost) {
  const Context context;
  return noise_in_kernels(SpatialIndex(points, context), most, context);
}

/// Of the true noise.
double share_read(const Positions& points) {
  const auto read = read_from(points);
  return read ? read->sigma.value_or(0) / kNoiseInSlab : 0;
}

Eigen::Vector3d plane(double u, double v) {
  return {u, v, 0};
}

TEST(NarrowKernel, ReadsTheNoiseOfAPlaneAndOfASphere) {
  EXPECT_NEAR(share_read(noisy(8000, plane)), 1, 0.1);
  const auto sphere = [](double u, double v) {
    const double z = 2 * v - 1, r = std::sqrt(1 - z * z), angle = 2 * M_PI * u;
    return Eigen::Vector3d(0.3 * r * std::cos(angle), 0.3 * r * std::sin(angle), 0.3 * z);
  };
  EXPECT_NEAR(share_read(noisy(10000, sphere)), 1, 0.1);
}

TEST(NarrowKernel, ReadsTheNoiseOfRodsAndStacksAFewSigmaThick) {
  for (const double sigmas : {2.0, 3.0, 5.0})
    EXPECT_NEAR(
        share_read(noisy(10000, [&](double u, double v) { return rod(sigmas * kNoiseInSlab, u, v); })), 1,
        0.15)
        << "rods with a radius of " << sigmas << " sigma";
  for (const double sigmas : {3.0, 4.0})
    for (const int sheets : {2, 5})
      EXPECT_NEAR(
          share_read(noisy(std::size_t(sheets) * 6000,
                           [&](double u, double v) { return stack(sheets, sigmas * kNoiseInSlab, u, v); })),
          1, 0.3)
          << sheets << " sheets, " << sigmas << " sigma apart";
}

TEST(NarrowKernel, FollowsTurnsAndScales) {
  Positions points = noisy(8000, plane);
  const auto read = read_from(points);
  ASSERT_TRUE(read && read->sigma);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (Eigen::Vector3d& p : points) p = 40 * (turn * p) + Eigen::Vector3d(5, -3, 8);
  const auto again = read_from(points, 40 * kMost);
  ASSERT_TRUE(again && again->sigma);
  EXPECT_NEAR(*again->sigma / *read->sigma, 40, 1e-6);
  EXPECT_NEAR(again->bound / read->bound, 40, 1e-6);
}

TEST(NarrowKernel, BoundsNoiseOfLessThanASpacingAndDoesNotTellIt) {
  for (const std::size_t points : {150, 250, 400}) {
    const auto read = read_from(noisy(points, plane));
    ASSERT_TRUE(read) << points;
    EXPECT_FALSE(read->sigma) << points;
    EXPECT_GT(read->bound, 0.9 * kNoiseInSlab) << points;
    EXPECT_LT(read->bound, 1.6 * kNoiseInSlab) << points;
  }
}

TEST(NarrowKernel, TellsNothingOfExactPoints) {
  const auto read = read_from(test::random_points(test::cube(), 5000, 1));
  EXPECT_FALSE(read && read->sigma);
}

}  // namespace
