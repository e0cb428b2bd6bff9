#include "clouds/shapes/random.h"

#include <cmath>

#include <gtest/gtest.h>

using rfsmooth::clouds::Random;

namespace {

TEST(Random, NormalNumbersHaveTheMomentsAndTailsOfTheNormalLaw) {
  Random random(1);
  constexpr int kCount = 400000;
  double sum = 0, squares = 0, fourth = 0;
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    beyond_two += std::abs(x) > 2;
  }
  // Each bound is five standard errors of its estimate.
  EXPECT_NEAR(sum / kCount, 0, 5 / std::sqrt(double(kCount)));
  EXPECT_NEAR(squares / kCount, 1, 5 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(fourth / kCount, 3, 5 * std::sqrt(96.0 / kCount));
  EXPECT_NEAR(double(beyond_two) / kCount, std::erfc(std::sqrt(2.0)), 5 * std::sqrt(0.0455 / kCount));
}

TEST(Random, SameSeedSameNumbersOtherSeedOthers) {
  Random a(7), b(7), c(8);
  for (int i = 0; i < 100; ++i) {
    const double x = a.normal();
    EXPECT_EQ(x, b.normal());
    EXPECT_NE(x, c.normal());
  }
}

TEST(Random, DirectionsHaveUnitLengthAndNoPreference) {
  Random random(2);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int i = 0; i < 100000; ++i) {
    const Eigen::Vector3d d = random.direction();
    EXPECT_NEAR(d.norm(), 1, 1e-12);
    mean += d / 100000;
  }
  EXPECT_LT(mean.norm(), 5 / std::sqrt(100000.0));
}

}  // namespace
