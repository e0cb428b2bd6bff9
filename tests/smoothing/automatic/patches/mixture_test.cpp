#include "smoothing/automatic/patches/mixture.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

using rfsmooth::smoothing::Mixture;

namespace {

using Values = std::vector<float>;
using Sigma = std::vector<double>;

TEST(Mixture, AloneTheDataAreTheirOwnMixture) {
  const Values data{1, -2, 3};
  Values height, own;
  std::vector<double> shares;
  Mixture(data).average(height, own, shares, Values(3, 1), Sigma(3, 1), {});
  EXPECT_EQ(height, data);
  EXPECT_EQ(own, Values(3, 1));
}

TEST(Mixture, LargeEvidenceDecidesAndEvidenceAddsUpAlongTheChain) {
  Mixture mixture({0, 0, 0});
  mixture.add({1, 1, 1}, {0.5F, 0.5F, 0.5F}, {60, -60, 60}, {});
  mixture.add({2, 2, 2}, {0.1F, 0.1F, 0.1F}, {60, 60, -60}, {});  // in all: 120, 0, 0
  Values height, own;
  std::vector<double> shares;
  mixture.average(height, own, shares, Values(3, 1), Sigma(3, 1), {});
  EXPECT_NEAR(height[0], 2, 1e-9);
  EXPECT_NEAR(own[0], 0.1, 1e-6);
  EXPECT_GT(height[1], 0);  // the data and the second candidate, by their shares in the cloud
  EXPECT_LT(height[1], 2);
  EXPECT_NEAR(height[2], 1, 1e-9);
}

TEST(Mixture, WhereThereIsNoPredictionTheOthersServe) {
  Mixture mixture({0, 0});
  mixture.add({1, 7}, {0.5F, 0.5F}, {60, std::nanf("")}, {});
  mixture.add({2, 2}, {0.1F, 0.1F}, {-120, 60}, {});
  Values height, own;
  std::vector<double> shares;
  mixture.average(height, own, shares, Values(2, 1), Sigma(2, 1), {});
  EXPECT_NEAR(height[0], 1, 1e-9);
  EXPECT_NEAR(height[1], 2, 1e-9);
}

TEST(Mixture, WhatIsLeftIsToldByTheScaleBeforeAndAtMostTheNoise) {
  Mixture mixture({0, 0, 0});
  mixture.add({1, 1, 1}, {0.5F, 0.5F, 0.5F}, {60, 60, 60}, {});
  mixture.add({1.3F, 1.6F, 2}, {0.1F, 0.1F, 0.1F}, {60, 60, -120}, {});
  Values height, own;
  std::vector<double> shares;
  const rfsmooth::smoothing::Left left = mixture.average(height, own, shares, Values(3, 1), {1, 0.5, 2}, {});
  EXPECT_NEAR(left.own, 0.5 * 4 / 3, 1e-6) << "of the third point, at the narrowest scale";
  EXPECT_GT(left.wider, (0.09 + 0.25) / 3) << "more than their difference, but no more than there was";
  EXPECT_LT(left.wider, (2 * 0.09 + 0.25) / 3 + 1e-6);
}

TEST(Mixture, TheRestOfTheCloudOutvotesFaintEvidence) {
  const std::size_t n = 1000;
  Values gain(n, 20), one(n, 1), zero(n, 0);
  gain[7] = -1;  // alone, this would leave three quarters of the weight with the data
  Mixture mixture(zero);
  mixture.add(one, zero, gain, {});
  Values height, own;
  std::vector<double> shares;
  mixture.average(height, own, shares, Values(n, 1), Sigma(n, 1), {});
  EXPECT_GT(height[7], 0.9);
  gain[7] = -30;  // but certainty counts
  Mixture certain(zero);
  certain.add(one, zero, gain, {});
  shares.clear();
  certain.average(height, own, shares, Values(n, 1), Sigma(n, 1), {});
  EXPECT_LT(height[7], 0.01);
}

// Of a thousand points half say that the data are right; where these count for nothing, the faint evidence of
// one point is outvoted by the other half.
TEST(Mixture, PointsThatDoNotCountHaveNoVote) {
  const std::size_t n = 1000;
  Values gain(n, 20), one(n, 1), zero(n, 0), say(n, 1), height, own;
  for (std::size_t i = n / 2; i < n; ++i) gain[i] = -20;
  gain[7] = -1;
  double counted = 0;
  for (const bool all : {true, false}) {
    for (std::size_t i = n / 2; i < n && !all; ++i) say[i] = 0;
    Mixture mixture(zero);
    mixture.add(one, zero, gain, {});
    std::vector<double> shares;
    mixture.average(height, own, shares, say, Sigma(say.size(), 1), {});
    EXPECT_EQ(height[7] > 0.9, !all);
    counted = double(height[7]) - counted;
  }
  EXPECT_GT(counted, 0.5);
}

TEST(Mixture, StatesHowManyCandidatesItTakes) {
  Mixture mixture({0});
  for (int k = 0; k < 15; ++k) mixture.add({0.0F}, {0.0F}, {0.0F}, {});
  EXPECT_THROW(mixture.add({0.0F}, {0.0F}, {0.0F}, {}), std::length_error);
}

}  // namespace
