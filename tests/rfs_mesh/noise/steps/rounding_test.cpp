#include "rfs_mesh/noise/steps/rounding.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "rfs_mesh/noise/noise.h"

using namespace rfsmooth;

namespace {

Positions to_decimals(Positions points, double unit) {
  for (Eigen::Vector3d& p : points) p = unit * (p / unit).array().round().matrix();
  return points;
}

Positions random_in_cube(std::size_t count) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform(-5, 5);
  Positions points;
  for (std::size_t i = 0; i < count; ++i)
    points.emplace_back(uniform(engine), uniform(engine), uniform(engine));
  return points;
}

TEST(Rounding, IsThatOfDecimals) {
  for (const double unit : {0.25, 1e-2, 1e-3})
    EXPECT_NEAR(rfs_mesh::rounding_of(to_decimals(random_in_cube(2000), unit)), unit, 1e-9 * unit);
}

TEST(Rounding, OfFreeCoordinatesIsNextToNothing) {
  EXPECT_LT(rfs_mesh::rounding_of(random_in_cube(2000)), 1e-4);
  EXPECT_EQ(rfs_mesh::rounding_of({{1, 2, 3}}), 0);
}

TEST(Rounding, OfSinglePrecisionIsItsSevenDigits) {
  Positions far;
  for (const Eigen::Vector3d& p : random_in_cube(2000))
    far.push_back((p + Eigen::Vector3d(1000, 0, 0)).cast<float>().cast<double>());
  const double digits = rfs_mesh::seven_digits(far, {0, 0, 0});
  EXPECT_NEAR(digits, 2e-3, 1e-4);  // of 1,000
  EXPECT_LT(rfs_mesh::rounding_of(far), digits);
}

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
