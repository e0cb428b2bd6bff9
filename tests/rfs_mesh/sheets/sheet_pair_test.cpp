#include "rfs_mesh/sheets/sheet_pair.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

using namespace rfsmooth::rfs_mesh;

namespace {

double middle_at(double u, double v) {
  return 3 + 0.5 * u - v + 0.7 * u * u + 0.3 * u * v - 0.4 * v * v;
}

double apart_at(double u, double v, double apart) {
  return apart + 0.2 * u - 0.1 * v;
}

/// What was thought of the points before.
enum class Before { half_way, one_sheet };

/// Points on two sheets, `apart` from their middle, with noise.
std::vector<SheetPoint> sheets(std::size_t n, double apart, double noise, Before before, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> place(-1, 1);
  std::vector<SheetPoint> points;
  while (points.size() < n) {
    const double u = place(random), v = place(random), inside = 1 - (u * u + v * v);
    if (inside <= 0) continue;
    const double side = random() % 2 != 0 ? 1 : -1;
    const double sheet = middle_at(u, v) + side * apart_at(u, v, apart),
                 height = sheet + noise * gauss(random);
    const double share = before == Before::half_way ? 0.75 : 0;
    points.push_back(
        {u, v, height, middle_at(u, v) + share * side * apart_at(u, v, apart), inside * inside, 0});
  }
  return points;
}

TEST(SheetPair, FindsTheSheetsInNoise) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    auto points = sheets(600, 1.9, 1, Before::half_way, seed);
    const SheetPair fit(points);
    EXPECT_TRUE(fit.convincing());
    double error = 0, weights = 0;
    for (const SheetPoint& p : points) {
      const double upper = middle_at(p.u, p.v) + apart_at(p.u, p.v, 1.9),
                   lower = middle_at(p.u, p.v) - apart_at(p.u, p.v, 1.9), found = fit.nearer(p);
      error += p.weight * std::pow(std::min(std::abs(found - upper), std::abs(found - lower)), 2);
      weights += p.weight;
    }
    EXPECT_LT(error / weights, 0.1);  // of the noise's variance
  }
}

TEST(SheetPair, AreExactWithoutNoise) {
  auto points = sheets(300, 3, 0, Before::half_way);
  const SheetPair fit(points);
  for (const SheetPoint& p : points) EXPECT_NEAR(fit.nearer(p), p.height, 1e-4);
}

TEST(SheetPair, UpsideDownIsTheSame) {
  auto points = sheets(400, 1.9, 1, Before::half_way), turned = points;
  for (SheetPoint& p : turned) {
    p.height = -p.height;
    p.estimate = -p.estimate;
  }
  const SheetPair fit(points), other(turned);
  EXPECT_EQ(fit.convincing(), other.convincing());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(fit.nearer(points[i]), -other.nearer(turned[i]), 1e-9);
    EXPECT_NEAR(points[i].upper, 1 - turned[i].upper, 1e-9);
  }
}

TEST(SheetPair, OneSheetHasNone) {
  for (const double louder : {1.0, 1.5, 2.5}) {
    auto points = sheets(600, 0, louder, Before::half_way);
    EXPECT_FALSE(SheetPair(points).convincing()) << louder;
  }
}

TEST(SheetPair, FarApartOnesAndThoseThatNothingElseShowsAreLeftAlone) {
  auto far = sheets(600, 3, 1, Before::half_way), hidden = sheets(600, 1.9, 1, Before::one_sheet);
  EXPECT_FALSE(SheetPair(far).convincing());
  EXPECT_FALSE(SheetPair(hidden).convincing());
}

TEST(SheetPair, AStepIsNoWall) {
  auto points = sheets(600, 1.9, 1, Before::half_way);
  for (SheetPoint& p : points) {
    const double step = p.u < 0.1 ? -1.9 : 1.9, noise = p.height - p.estimate;
    p.estimate = 0.75 * step;
    p.height = step + 0.4 * noise;
  }
  EXPECT_FALSE(SheetPair(points).convincing());
}

TEST(SheetPair, SheetsOfAnotherShapeAreNotTakenForThese) {
  auto points = sheets(600, 1.9, 0.8, Before::half_way);
  for (SheetPoint& p : points) {
    const double wave = 1.2 * std::sin(6 * p.u);
    p.height += wave;
    p.estimate += wave;
  }
  EXPECT_FALSE(SheetPair(points).convincing());
}

TEST(SheetPair, WhatSomeOfThePointsRuleOutAllOfThemDoNotShow) {
  for (const double wave : {0.0, 4.0})
    for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
      auto all = sheets(1200, 1.9, 1, Before::half_way, seed);
      std::vector<SheetPoint> some;
      for (std::size_t i = 0; i < all.size(); ++i) {
        all[i].height += wave * std::sin(6 * all[i].u);
        if (i % 2 == 0) some.push_back(all[i]);
      }
      EXPECT_EQ(SheetPair(some).possible(), wave == 0);
      EXPECT_LE(SheetPair(all).convincing(), SheetPair(some).possible());
    }
}

TEST(SheetPair, FewPointsSayNothing) {
  auto points = sheets(40, 1.9, 1, Before::half_way);
  EXPECT_FALSE(SheetPair(points).convincing());
  points.resize(20);
  EXPECT_TRUE(SheetPair(points).possible());
  std::vector<SheetPoint> none;
  EXPECT_FALSE(SheetPair(none).convincing());
}

}  // namespace
