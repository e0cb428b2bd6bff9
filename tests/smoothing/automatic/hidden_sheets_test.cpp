#include "smoothing/automatic/hidden_sheets.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/near.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

constexpr int kSide = 120;

/// partly_uniform: Gaussian, and uniform what louder places have on top.
enum class Noise { gaussian, uniform, partly_uniform };

/// Noisy heights over a flat guide, smoothed to zero, where points of the left third (or of all) truly are at
/// +-`wall` and those of the right third have `louder` times the noise of 1. `truth`: where they are without
/// noise. `denser`: the left third has so many times the points on the same area.
struct Sheet {
  Sheet(double wall, double louder, Noise kind = Noise::gaussian, int side = kSide, bool everywhere = false,
        double denser = 2) {
    std::mt19937 random(7);
    std::normal_distribution<double> gauss;
    std::uniform_real_distribution<double> even(-std::sqrt(3.0), std::sqrt(3.0));
    const auto noise = [&](std::mt19937& engine) {
      return kind == Noise::uniform ? even(engine) : gauss(engine);
    };
    const double on_top = std::sqrt(louder * louder - 1);
    Positions guide, data;
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j) {
        const bool left = everywhere || i < side / 3, right = i >= 2 * side / 3;
        const double x = i + 0.3 * std::sin(5.0 * j), border = side / 3;
        guide.emplace_back(wall > 0 && x < border ? border + (x - border) / denser : x,
                           j + 0.3 * std::cos(3.0 * i), 0);
        truth.push_back(left ? (random() % 2 != 0 ? wall : -wall) : 0);
        data.push_back(guide.back());
        if (kind == Noise::partly_uniform)
          data.back().z() = truth.back() + gauss(random) + (right ? on_top * even(random) : 0);
        else
          data.back().z() = truth.back() + (right ? louder : 1) * noise(random);
      }
    field = std::make_unique<HeightField>(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data,
                                          NoiseModel(), Context{});
    field->ready_for_means({});
    height.assign(guide.size(), 0);
    own.assign(guide.size(), 0.01F);
  }

  /// Mean squared distance to the surface: to the nearer sheet.
  double error() const {
    double sum = 0;
    for (std::size_t i = 0; i < height.size(); ++i)
      sum += std::pow(std::abs(double(height[i])) - std::abs(truth[i]), 2);
    return sum / double(height.size());
  }

  /// Points put onto one of two sheets.
  std::size_t moved() const {
    return height.size() - std::size_t(std::count(height.begin(), height.end(), 0.0F));
  }

  /// From a measured noise of `sigma`. \param apart NoiseModel::apart
  HiddenSheets split(double sigma, bool with_tails = false, double apart = 0) {
    Residuals left{std::vector<float>(height.size()), sigma, apart, with_tails};
    for (std::size_t i = 0; i < height.size(); ++i)
      left.scores[i] = float(std::clamp((field->height(i) - double(height[i])) / sigma, -5.0, 5.0));
    std::optional<Statistics::Sheets> known;
    return split_hidden_sheets(*field, left, height, own, 1, known, {});
  }

  std::unique_ptr<HeightField> field;
  std::vector<double> truth;
  std::vector<float> height, own;
};

TEST(HiddenSheets, PointsOfAWallThinnerThanTheNoiseGoToItsTwoSheets) {
  for (const double measured : {1.0, 1.1}) {  // walls raise the measured noise
    Sheet sheet(1, 1);
    const double film = sheet.error();
    const HiddenSheets found = sheet.split(measured);
    EXPECT_GT(found.evidence, 7);
    EXPECT_NEAR(found.variance * measured * measured, 1, 0.15);
    EXPECT_NEAR(double(sheet.moved()), kSide * kSide / 3.0, kSide * kSide / 20.0);
    EXPECT_LT(sheet.error(), 0.2 * film);
  }
}

// Thinned to a distance of 0.6 from each other: points of one sheet, which are 1 and 0.7 apart here.
TEST(HiddenSheets, AreSeenAmongPointsThatKeepADistance) {
  Sheet sheet(1, 1);
  const double film = sheet.error();
  EXPECT_TRUE(sheet.split(1, false, 0.6).there());
  EXPECT_LT(sheet.error(), 0.2 * film);
}

TEST(HiddenSheets, LayersOfScansAreNotDenserAndAreNotTakenForThem) {
  Sheet sheet(1, 1, Noise::gaussian, kSide, false, 1);
  EXPECT_FALSE(sheet.split(1).there());
  EXPECT_EQ(sheet.moved(), 0u);
}

TEST(HiddenSheets, LouderNoiseIsNotTakenForThem) {
  for (const double louder : {1.2, 1.4, 1.8}) {
    Sheet sheet(0, louder);
    EXPECT_FALSE(sheet.split(1).there()) << louder;
    EXPECT_EQ(sheet.moved(), 0u);
  }
}

// Noise that is even in part is nearer to that of two sheets than Gaussian noise is, but not near enough, and
// many points do not make it so.
TEST(HiddenSheets, LittleThatLooksLikeThemInManyPointsIsNotTakenForThem) {
  for (const int side : {kSide, 2 * kSide, 3 * kSide}) {
    Sheet sheet(0, 1.2, Noise::partly_uniform, side);
    EXPECT_FALSE(sheet.split(1).there()) << side;
    EXPECT_EQ(sheet.moved(), 0u);
  }
}

// It is flatter than Gaussian noise, as that of two sheets is.
TEST(HiddenSheets, UniformNoiseIsNotTakenForThem) {
  Sheet sheet(0, 1, Noise::uniform);
  EXPECT_FALSE(sheet.split(1).there());
  EXPECT_EQ(sheet.moved(), 0u);
}

// Walls everywhere: the noise itself could be so flat, unless it is known to have tails.
TEST(HiddenSheets, OfNoiseWithTailsAllOfACloudMayBeWalls) {
  Sheet sheet(1, 1, Noise::gaussian, kSide, true);
  const double film = sheet.error();
  EXPECT_FALSE(sheet.split(1.1).there());
  EXPECT_EQ(sheet.moved(), 0u);
  EXPECT_TRUE(sheet.split(1.1, true).there());
  EXPECT_GT(double(sheet.moved()), 0.8 * kSide * kSide);
  EXPECT_LT(sheet.error(), 0.3 * film);
}

}  // namespace
