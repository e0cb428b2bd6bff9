#include "rfs_mesh/noise/narrow_kernel.h"

#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "rfs_mesh/noise/noise.h"
#include "tests/support/shapes.h"

using namespace rfsmooth;
using rfs_mesh::noise_in_kernels;
using rfs_mesh::SpatialIndex;

namespace {

constexpr double kNoiseInSlab = 0.03, kMost = 5 * kNoiseInSlab;

/// So many points of a surface, given by two uniform numbers, with isotropic noise.
Positions noisy(std::size_t n, const std::function<Eigen::Vector3d(double, double)>& surface) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal(0, kNoiseInSlab);
  std::uniform_real_distribution<double> uniform;
  Positions points(n);
  for (Eigen::Vector3d& p : points) {
    const double u = uniform(engine), v = uniform(engine);
    const double x = normal(engine), y = normal(engine), z = normal(engine);
    p = surface(u, v) + Eigen::Vector3d(x, y, z);
  }
  return points;
}

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

/// Along z, of length 2.
Eigen::Vector3d rod(double radius, double u, double v) {
  const double angle = 2 * M_PI * u;
  return {radius * std::cos(angle), radius * std::sin(angle), 2 * v};
}

/// So many sheets of 1 x 1, so far apart.
Eigen::Vector3d stack(int sheets, double apart, double u, double v) {
  const double of_all = sheets * u, sheet = std::floor(of_all);
  return {of_all - sheet, v, apart * sheet};
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

// Windows alone took it for 2.9 and 1.5 times as much, and smoothed stacks to less than they were.
TEST(NarrowKernel, BoundsTheWholeMeasureOnStacksAndRods) {
  const auto measured = [](const Positions& points) {
    const Context context;
    return rfs_mesh::measure_noise(SpatialIndex(points, context), context).sigma / kNoiseInSlab;
  };
  EXPECT_NEAR(measured(noisy(24000, [](double u, double v) { return stack(5, 3 * kNoiseInSlab, u, v); })),
              1.3, 0.3);
  EXPECT_NEAR(measured(noisy(10000, [](double u, double v) { return rod(1.5 * kNoiseInSlab, u, v); })), 1.2,
              0.2);
  // Noise of 0.8 spacings, which windows alone took for 2.8 times as much.
  EXPECT_NEAR(measured(noisy(1972, [](double u, double v) { return stack(3, 3.5 * kNoiseInSlab, u, v); })),
              1.3, 0.3);
}

}  // namespace
