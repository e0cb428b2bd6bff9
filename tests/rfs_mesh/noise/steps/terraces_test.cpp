#include "rfs_mesh/noise/steps/terraces.h"

#include <cmath>

#include <gtest/gtest.h>

using namespace rfsmooth;
using rfs_mesh::Terraces;

namespace {

constexpr double kStep = 1.0 / 128;

/// Depths along z at 100 to 299 steps, of which every seventh is missing, and at 97, told a hundredth of a
/// step too small.
Terraces with_gaps() {
  Terraces terraces;
  terraces.same = kStep / 64;
  terraces.depths.push_back(96.99 * kStep);
  for (int k = 100; k < 300; ++k)
    if (k % 7 != 0) terraces.depths.push_back(k * kStep);
  return terraces;
}

TEST(Terraces, AreFilledInWithStepsOfTheSizeThatTheFarthestTell) {
  Terraces terraces = with_gaps();
  ASSERT_TRUE(rfs_mesh::fill_in({{0, 0, 50 * kStep}, {0, 0, 900 * kStep}}, terraces));
  EXPECT_NEAR(terraces.typical, kStep, 1e-12);
  EXPECT_EQ(terraces.depths.size(), 851U);
  for (const int k : {50, 97, 105, 299, 700, 900}) {
    const auto at = terraces.step_of({0, 0, k * kStep});
    ASSERT_TRUE(at) << k;
    EXPECT_NEAR(terraces.gap(terraces.depths[*at]), kStep, 1e-12);
  }
  EXPECT_FALSE(terraces.step_of({0, 0, 105.5 * kStep}));
}

TEST(Terraces, TheirStripsAreAsWideAsTheSlopeLeavesThem) {
  Terraces planes = with_gaps();
  ASSERT_TRUE(rfs_mesh::fill_in({{0, 0, kStep}}, planes));
  Terraces shells = planes;
  shells.scanner = Eigen::Vector3d(0, 0, -1);
  const Eigen::Vector3d at(0, 0, 0), facing = Eigen::Vector3d::UnitZ(), along = Eigen::Vector3d::UnitX();
  for (const Terraces& terraces : {planes, shells}) {
    EXPECT_NEAR(terraces.width(at, (facing + along).normalized()), std::sqrt(2.0) * kStep, 1e-12);
    EXPECT_NEAR(terraces.width(at, along), kStep, 1e-12);
    EXPECT_TRUE(std::isinf(terraces.width(at, facing)));
  }
}

TEST(Terraces, OfUnequalStepsAreNotFilledIn) {
  Terraces disparities;
  disparities.same = 1e-5;
  for (int k = 299; k >= 100; --k) disparities.depths.push_back(100.0 / k);
  const std::vector<double> before = disparities.depths;
  EXPECT_FALSE(rfs_mesh::fill_in({{0, 0, 1}}, disparities));
  EXPECT_EQ(disparities.depths, before);

  Terraces near = with_gaps();  // told so coarsely that most depths would be on them
  near.same = kStep / 7;
  EXPECT_FALSE(rfs_mesh::fill_in({{0, 0, 1}}, near));
}

}  // namespace
