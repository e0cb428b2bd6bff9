#include "rfs_mesh/noise/steps/rounding.h"

#include <random>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "tests/rfs_mesh/noise/steps/to_decimals.h"

using namespace rfsmooth;

namespace {

using test::to_decimals;

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

}  // namespace
