#include "rfs_mesh/sheets/two_sheets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>
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

/// Heights on two parallel planes with their labels.
struct LabelledHeights {
  std::vector<Eigen::Vector2d> uv;
  std::vector<double> height, label, weight;

  LabelledHeights(double middle, const Eigen::Vector2d& slope, double apart, double noise) {
    std::mt19937 random(3);
    std::normal_distribution<double> gauss;
    std::uniform_real_distribution<double> place(-1, 1);
    for (int i = 0; i < 2000; ++i) {
      uv.emplace_back(place(random), place(random));
      label.push_back(i % 3 == 0 ? 1 : -1);
      weight.push_back(0.5 + 0.4 * place(random));
      height.push_back(middle + slope.dot(uv.back()) + label.back() * apart + noise * gauss(random));
    }
  }

  LabelledSheets::Fit fit() const {
    LabelledSheets sheets;
    for (std::size_t i = 0; i < uv.size(); ++i) sheets.add(uv[i], height[i], label[i], weight[i]);
    return sheets.fit();
  }
};

TEST(LabelledSheets, AreExactWithoutNoise) {
  LabelledHeights heights(0.3, {0.5, -0.2}, 0.7, 0);
  heights.uv.emplace_back(0, 0);  // a stray without weight
  heights.height.push_back(100);
  heights.label.push_back(1);
  heights.weight.push_back(0);
  const LabelledSheets::Fit fit = heights.fit();
  EXPECT_NEAR(fit.middle, 0.3, 1e-7);
  EXPECT_NEAR(fit.slope.x(), 0.5, 1e-7);
  EXPECT_NEAR(fit.slope.y(), -0.2, 1e-7);
  EXPECT_NEAR(fit.apart, 0.7, 1e-7);
  EXPECT_NEAR(fit.variance, 0, 1e-7);
}

TEST(LabelledSheets, FindTheNoiseAndTheSheetsInIt) {
  const LabelledSheets::Fit fit = LabelledHeights(0.3, {0.5, -0.2}, 0.7, 0.4).fit();
  EXPECT_NEAR(fit.middle, 0.3, 0.05);
  EXPECT_NEAR((fit.slope - Eigen::Vector2d(0.5, -0.2)).norm(), 0, 0.1);
  EXPECT_NEAR(fit.apart, 0.7, 0.05);
  EXPECT_NEAR(fit.variance, 0.16, 0.03);
}

TEST(LabelledSheets, TheUpperOneMayBeBelow) {
  EXPECT_NEAR(LabelledHeights(1, {0, 0.1}, -0.2, 0).fit().apart, -0.2, 1e-7);
}

/// Mean square about the means of the first `lower` and of the others, the long way.
double variance_of_split(const std::vector<double>& heights, std::size_t lower) {
  double squares = 0;
  for (const auto& [begin, end] : {std::pair(std::size_t(0), lower), std::pair(lower, heights.size())}) {
    double mean = 0;
    for (std::size_t i = begin; i < end; ++i) mean += heights[i] / double(end - begin);
    for (std::size_t i = begin; i < end; ++i) squares += std::pow(heights[i] - mean, 2);
  }
  return squares / double(heights.size());
}

TEST(SplitHeights, PartsTwoClusters) {
  const std::vector<double> heights = {-1.2, -1, -0.8, 2, 3, 3, 4};
  const SplitHeights split = split_heights(heights, 2);
  EXPECT_EQ(split.lower, 3u);
  EXPECT_NEAR(split.variance, (0.08 + 2) / 7, 1e-12);
}

TEST(SplitHeights, HasTheLeastVarianceOfAllSplits) {
  std::mt19937 random(5);
  std::normal_distribution<double> gauss;
  constexpr std::size_t kLeast = 5;
  for (const std::size_t n : {10U, 11U, 48U})
    for (int again = 0; again < 20; ++again) {
      std::vector<double> heights(n);
      for (double& h : heights) h = gauss(random) + (random() % 3 == 0 ? 2 : 0);
      std::sort(heights.begin(), heights.end());
      const SplitHeights split = split_heights(heights, kLeast);
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = kLeast; k + kLeast <= n; ++k)
        least = std::min(least, variance_of_split(heights, k));
      EXPECT_NEAR(split.variance, least, 1e-12);
      EXPECT_NEAR(variance_of_split(heights, split.lower), least, 1e-12);
    }
}

TEST(SplitHeights, StraysMakeNoSheet) {
  const std::vector<double> heights = {-90, -80, 1, 1.1, 1.2, 1.3, 2.1, 2.2, 2.3, 2.4};
  EXPECT_EQ(split_heights(heights, 1).lower, 2u);
  EXPECT_EQ(split_heights(heights, 3).lower, 3u);
}

/// Fourth moment over the square of the second, of two sheets at +-d in normal noise of variance c.
double flatness_of_two(double d, double c) {
  return (std::pow(d, 4) + 6 * d * d * c + 3 * c * c) / std::pow(d * d + c, 2);
}

TEST(ShareOfSheet, IsThatOfTheNoise) {
  for (const double d : {0.0, 0.5, 1.0, 3.0})
    for (const double c : {0.5, 1.0, 2.0})
      EXPECT_NEAR(share_of_sheet(flatness_of_two(d, c)), c / (c + d * d), 1e-7) << d << " " << c;
}

TEST(ShareOfSheet, IsThatOfTheNoiseOfUnequalSheetsAndTellsTheirGap) {
  for (const double p : {0.1, 0.3, 0.45})
    for (const double gap : {0.5, 2.0, 6.0}) {
      constexpr double kNoise = 0.7;  // variance
      // Central moments of the mixture, from those of its two normal distributions about their mean.
      double second = 0, third = 0, fourth = 0;
      for (const auto& [weight, d] : {std::pair(p, (1 - p) * gap), std::pair(1 - p, -p * gap)}) {
        second += weight * (d * d + kNoise);
        third += weight * (d * d * d + 3 * d * kNoise);
        fourth += weight * (std::pow(d, 4) + 6 * d * d * kNoise + 3 * kNoise * kNoise);
      }
      const double flatness = fourth / (second * second), lean = third * third / std::pow(second, 3);
      const double of_sheet = share_of_sheet(flatness, lean);
      EXPECT_NEAR(of_sheet, kNoise / second, 1e-7) << p << " " << gap;
      EXPECT_NEAR(squared_gap(of_sheet, lean), gap * gap / second, 1e-4) << p << " " << gap;
    }
  EXPECT_DOUBLE_EQ(share_of_sheet(1, 1), 0);  // no distribution has that
}

TEST(ShareOfSheet, ByHand) {  // 1 - sqrt((3 - k) / 2)
  EXPECT_DOUBLE_EQ(share_of_sheet(2.5), 0.5);
  EXPECT_DOUBLE_EQ(share_of_sheet(1), 0);
  EXPECT_DOUBLE_EQ(share_of_sheet(3), 1);
  EXPECT_DOUBLE_EQ(share_of_sheet(0.5), 0);  // no distribution has that
  EXPECT_DOUBLE_EQ(share_of_sheet(6), 1);    // heavy tails
  EXPECT_NEAR(kFlatnessOfSheets, (3 + flatness_of_two(2.5, 1)) / 2, 0.01);
}

/// How far points are above the middle: of two sheets or, with the same variance, of one.
Eigen::ArrayXd heights_above(double d, double c, bool two) {
  std::mt19937 random(11);
  std::normal_distribution<double> gauss;
  Eigen::ArrayXd above(20000);
  for (double& e : above)
    e = two ? (random() % 2 != 0 ? d : -d) + std::sqrt(c) * gauss(random)
            : std::sqrt(c + d * d) * gauss(random);
  return above;
}

double evidence(const Eigen::ArrayXd& above, double c) {
  const Eigen::ArrayXd squared =
                           Eigen::ArrayXd::Constant(above.size(), squared_apart(above.square().mean(), c)),
                       variance = Eigen::ArrayXd::Constant(above.size(), c);
  return evidence_of_two(above, squared, variance).sum();
}

TEST(EvidenceOfTwo, IsForSheetsWhereThereAreTwoAndAgainstThemElsewhere) {
  for (const double c : {0.7, 1.0})
    for (const double d : {0.8, 1.2, 2.0}) {
      EXPECT_GT(evidence(heights_above(d, c, true), c), kNatsOfTwo) << c << " " << d;
      EXPECT_LT(evidence(heights_above(d, c, false), c), -kNatsOfTwo) << c << " " << d;
    }
}

TEST(EvidenceOfTwo, IsTheRatioOfTheDensities) {
  using One = Eigen::Array<double, 1, 1>;
  using Four = Eigen::Array<float, 4, 1>;
  const auto density = [](double e, double c) {
    return std::exp(-e * e / (2 * c)) / std::sqrt(2 * M_PI * c);
  };
  for (const double e : {-4.0, -0.7, 0.0, 1.0, 3.0})
    for (const double d : {0.0, 0.3, 1.0, 2.0})
      for (const double c : {0.6, 1.0}) {
        const double ratio = std::log((density(e - d, c) + density(e + d, c)) / 2 / density(e, c + d * d));
        EXPECT_NEAR(evidence_of_two(One(e), One(d * d), One(c))[0], ratio, 1e-12);
        const Four of_four =
            evidence_of_two(Four(Four::Constant(float(e))), Four(Four::Constant(float(d * d))),
                            Four(Four::Constant(float(c))));
        EXPECT_NEAR(double(of_four[3]), ratio, 2e-5);
      }
}

TEST(Labels, AreThoseOfTheNearerSheetWhereTheSheetsAreFarApart) {
  for (const double above : {-3.0, -0.1, 0.1, 3.0}) {
    EXPECT_EQ(nearer_label(above), above < 0 ? -1 : 1);
    EXPECT_NEAR(expected_label(above, 100, 1), nearer_label(above), 1e-7);
    EXPECT_NEAR(sharpened_label(above, 100, 1), nearer_label(above), 1e-7);
    EXPECT_NEAR(expected_label(above, 1e-9, 1), 0, 1e-8);
    EXPECT_NEAR(sharpened_label(above, 1e-9, 1), 0, 1e-8);
  }
}

TEST(Labels, ExpectedAreThoseOfLeastSquaredError) {
  constexpr double kApart = 0.8, kVariance = 1;
  std::mt19937 random(13);
  std::normal_distribution<double> gauss;
  double expected = 0, nearer = 0, sharpened = 0, none = 0;
  for (int i = 0; i < 20000; ++i) {
    const double s = random() % 2 != 0 ? 1 : -1, above = s * kApart + std::sqrt(kVariance) * gauss(random);
    expected += std::pow(expected_label(above, kApart, kVariance) - s, 2);
    sharpened += std::pow(sharpened_label(above, kApart, kVariance) - s, 2);
    nearer += std::pow(nearer_label(above) - s, 2);
    none += 1;
  }
  EXPECT_LT(expected, 0.9 * none);
  EXPECT_LT(expected, 0.9 * sharpened);
  EXPECT_LT(sharpened, nearer);  // and on the way from one to the other
}

TEST(Labels, AreSharpenedWhereTheSheetsAreFarEnoughApart) {
  for (const double above : {-2.0, -0.4, 0.4, 2.0}) {
    EXPECT_EQ(sharpened_label(above, 0.7, 1), expected_label(above, 0.7, 1));        // d^2 = 0.49
    EXPECT_EQ(sharpened_label(above, 0.72, 1), expected_label(above, 4 * 0.72, 1));  // 0.52
    EXPECT_GT(std::abs(sharpened_label(above, 0.72, 1)), std::abs(expected_label(above, 0.72, 1)));
    EXPECT_LE(std::abs(sharpened_label(above, 0.72, 1)), 1);
    EXPECT_EQ(sharpened_label(-above, 0.72, 1), -sharpened_label(above, 0.72, 1));
    const double odds = std::exp(2 * 0.7 * above);  // P over 1 - P
    EXPECT_NEAR(expected_label(above, 0.7, 1), (odds - 1) / (odds + 1), 1e-12);
  }
}

}  // namespace
