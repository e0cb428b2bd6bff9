/// What the growths of scatter tell: noise that neighbours share, bumps, ground.
#include "rfs_mesh/noise/shared/growths.h"

#include <initializer_list>

#include <gtest/gtest.h>

namespace rfsmooth::rfs_mesh {
namespace {

/// Enters growths one after the other, of scatter that is not the points' own; returns the last of `enter`.
bool enter_all(Growths& growths, std::initializer_list<double> times) {
  bool overtakes = false;
  for (const double t : times) overtakes = growths.enter(1, t, 0);
  return overtakes;
}

TEST(Growths, SlowOnesAreNoiseUntilOtherShapeOvertakes) {
  Growths growths(false);
  EXPECT_FALSE(enter_all(growths, {1.5}));
  EXPECT_TRUE(growths.counts());
  EXPECT_TRUE(enter_all(growths, {3}));
  EXPECT_FALSE(growths.counts());
}

TEST(Growths, OneSlowOneMayBeTheEndOfABump) {
  Growths growths(false);
  enter_all(growths, {3, 1.2});
  EXPECT_FALSE(growths.counts());
  enter_all(growths, {1.2});
  EXPECT_TRUE(growths.counts());
}

TEST(Growths, OnTerracesAllFromTheFirstSlowOneOn) {
  Growths growths(true);
  enter_all(growths, {3, 1.2, 3});
  EXPECT_TRUE(growths.counts());
}

TEST(Growths, OfGroundNeverStop) {
  Growths ground(false), noise(false), in_steps(true);
  enter_all(ground, {2.2, 1.6, 1.5});
  enter_all(noise, {2.2, 1.6, 1.1});
  enter_all(in_steps, {2.2, 1.6, 1.5});
  EXPECT_TRUE(ground.of_ground());
  EXPECT_FALSE(noise.of_ground());
  EXPECT_FALSE(in_steps.of_ground());
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
