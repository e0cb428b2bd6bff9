/// How many points share their noise, told by what quadrics through ever more points leave of it.
#include "rfs_mesh/noise/shared/signs_of_sharing.h"

#include <gtest/gtest.h>

namespace rfsmooth::rfs_mesh {
namespace {

const std::vector<double> kPatches = {16, 32, 64, 128, 256, 512, 1024, 2048, 4096};

/// What is left of noise of which a share is the points' own, and the rest that of k.
std::vector<double> left_of(double k, double own) {
  std::vector<double> left;
  for (const double m : kPatches) left.push_back(own + (1 - own) * left_by_quadric(k, m));
  return left;
}

TEST(SignsOfSharing, OfOneKindItIsTheNumberOfPoints) {
  for (const double k : {2.0, 7.0, 30.0, 180.0})
    EXPECT_NEAR(points_sharing(kPatches, left_of(k, 0)), k, 0.02 * k);
  EXPECT_LT(points_sharing(kPatches, left_of(1, 0)), 1.2);
}

TEST(SignsOfSharing, OfNoiseThatIsPartlyTheirOwnItIsTheMean) {
  for (const double k : {30.0, 180.0})
    for (const double own : {0.3, 0.5, 0.6})
      EXPECT_NEAR(points_sharing(kPatches, left_of(k, own)), own + (1 - own) * k, 0.15 * k)
          << k << ' ' << own;
}

TEST(SignsOfSharing, WhatSeesNoHalfTellsByItself) {
  const double k = 60;
  EXPECT_NEAR(points_sharing({64, 128}, {left_by_quadric(k, 64), left_by_quadric(k, 128)}), k, 0.15 * k);
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
