/// The measure of noise of one cloud whose file was written in several ways.
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "rfs_mesh/noise/noise.h"
#include "tests/rfs_mesh/noise/steps/to_decimals.h"

using namespace rfsmooth;

namespace {

using test::to_decimals;

/// A wavy wall before a camera that tells disparities, in steps of so much at its distance of 2.
Positions seen_in_steps(double step) {
  Positions points;
  for (int u = -80; u < 80; ++u)
    for (int v = -60; v < 60; ++v) {
      const double z = 2 + 0.0008 * u + 0.0015 * v + 0.03 * std::sin(u / 30.0), unit = step / 4,
                   told = 1 / (unit * std::round(1 / (z * unit)));
      points.emplace_back(u * told / 175, v * told / 175, told);
    }
  return points;
}

Positions registered(Positions points) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (Eigen::Vector3d& p : points)
    p = (turn * p + Eigen::Vector3d(1.3, -0.7, 2.1)).cast<float>().cast<double>();
  return points;
}

double noise_of(const Positions& points) {
  const Context context;
  return rfs_mesh::measure_noise(rfs_mesh::SpatialIndex(points, context), context).sigma;
}

// Within a step there is nothing but what coordinates were rounded by since, and it does not grow.
TEST(RoundedSteps, AreAsNoisyHoweverTheirFileWasMade) {
  for (const double step : {0.01, 0.02, 0.03}) {
    const Positions points = seen_in_steps(step);
    const double noise = noise_of(points);
    ASSERT_GT(noise, 0.2 * step);
    EXPECT_NEAR(noise_of(registered(points)) / noise, 1, 0.1) << step;
    EXPECT_NEAR(noise_of(to_decimals(points, 1e-3)) / noise, 1, 0.1) << step;
    EXPECT_NEAR(noise_of(to_decimals(registered(points), 1e-3)) / noise, 1, 0.1) << step;
  }
}

}  // namespace
