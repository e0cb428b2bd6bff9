#include "rfs_mesh/fit/scatter.h"

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

using namespace rfsmooth;
using rfs_mesh::Scatter;

namespace {

/// The fit to the m points nearest to the middle of a square of 3,000, of which `height` says how far they
/// lie off a quadric.
Scatter middle_fit(std::size_t m, const std::function<double(const Eigen::Vector3d&)>& height) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Positions points;
  for (int i = 0; i < 3000; ++i) {
    Eigen::Vector3d p(uniform(engine), uniform(engine), 0);
    p.z() = 0.2 * p.x() * p.x() - 0.1 * p.x() * p.y() + height(p);
    points.push_back(p);
  }
  const rfs_mesh::SpatialIndex index(points, {});
  rfs_mesh::KeptNeighbors kept(0);
  return rfs_mesh::ScatterFit()(index, Eigen::Vector3d::Zero(), m, 0, kept);
}

TEST(Scatter, FlatnessTellsNormalEvenAndTwoSheetsApart) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal(0, 0.01);
  std::uniform_real_distribution<double> even(-0.01, 0.01);
  std::bernoulli_distribution above;
  EXPECT_NEAR(middle_fit(1000, [&](const auto&) { return normal(engine); }).flatness, 3, 0.3);
  EXPECT_NEAR(middle_fit(1000, [&](const auto&) { return even(engine); }).flatness, 1.8, 0.1);
  EXPECT_NEAR(middle_fit(1000, [&](const auto&) { return above(engine) ? 0.01 : -0.01; }).flatness, 1, 0.05);
}

TEST(Scatter, LeanTellsUnequalSheetsFromAsManyPointsOnEach) {
  std::mt19937_64 engine(5);
  const auto lean_of = [&](double share) {
    std::bernoulli_distribution above(share);
    return middle_fit(1000, [&](const auto&) { return above(engine) ? 0.01 : 0.0; }).lean;
  };
  EXPECT_NEAR(lean_of(0.5), 0, 0.05);
  EXPECT_NEAR(lean_of(0.3), 0.4 * 0.4 / (0.3 * 0.7), 0.15);  // (1 - 2 p)^2 / (p (1 - p))
  EXPECT_NEAR(lean_of(0.7), 0.4 * 0.4 / (0.3 * 0.7), 0.15);
}

TEST(Scatter, WhatLeansInCommonIsNoChance) {
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal(0, 0.01);
  std::exponential_distribution<double> tail(100);
  double alike = 0, lean = 0, by_chance = 0;
  for (int round = 0; round < 300; ++round) {
    const auto fit = middle_fit(60, [&](const auto&) { return normal(engine); });
    alike += fit.lean_in_common / 300;
    by_chance += fit.lean / 300;
    lean += middle_fit(600, [&](const auto&) { return tail(engine); }).lean_in_common / 300;
  }
  EXPECT_NEAR(alike, -0.06, 0.06);  // a quadric makes quadrants lean against each other
  EXPECT_GT(by_chance, 0.1);
  // The square of the third moment of an exponential distribution cut off at c = 2.24 deviations, which is
  // 2 - exp(-1 - c) (6 + 6 c + 3 c^2).
  EXPECT_NEAR(lean, 0.42, 0.12);
}

TEST(Scatter, NearestPointsErrTogetherWhereTheyShareTheNoise) {
  std::mt19937_64 engine(6);
  std::normal_distribution<double> normal(0, 0.01);
  double alone = 0, shared = 0;
  for (int round = 0; round < 200; ++round) {
    alone += middle_fit(400, [&](const auto&) { return normal(engine); }).together / 200;
    const double turn = 100 * normal(engine);
    shared +=
        middle_fit(400, [&](const auto& p) { return 0.01 * std::sin(20 * p.x() + turn); }).together / 200;
  }
  EXPECT_NEAR(alone, 1, 0.3);
  EXPECT_GT(shared, 2 * alone);
}

// The lines of a scanner, each off by itself, whichever way they run; not what points have of their own.
TEST(Scatter, PointsErrInRowsWhereLinesAreOff) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0, 0.01);
  constexpr int kRounds = 200;
  double alone = 0, along_y = 0, aslant = 0;
  for (int round = 0; round < kRounds; ++round) {
    alone += middle_fit(100, [&](const auto&) { return normal(engine); }).in_rows / kRounds;
    std::vector<double> off(400);
    for (double& o : off) o = normal(engine);
    const auto line = [&](double across) { return off[std::size_t(200 + 25 * across)]; };
    along_y += middle_fit(100, [&](const auto& p) { return line(p.x()); }).in_rows / kRounds;
    aslant +=
        middle_fit(100, [&](const auto& p) { return line(0.6 * p.x() + 0.8 * p.y()); }).in_rows / kRounds;
  }
  EXPECT_NEAR(alone, 1, 0.4);  // less what the patch follows
  EXPECT_GT(along_y, 5 * alone);
  EXPECT_GT(aslant, 5 * alone);
}

// A wave is wider than what points resolve of it, a line is not.
TEST(Scatter, NextRowsAreAlikeInWavesAlone) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0, 0.01);
  constexpr int kRounds = 200;
  Scatter lines, waves;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> off(400);
    for (double& o : off) o = normal(engine);
    const auto line = [&](double across) { return off[std::size_t(200 + 25 * across)]; };
    const double turn = 100 * normal(engine);
    const Scatter of_line = middle_fit(400, [&](const auto&p) { return line(0.6 * p.x() + 0.8 * p.y()); }),
                  of_wave = middle_fit(400, [&](const auto&p) { return 0.01 * std::sin(20 * p.x() + turn); });
    lines.in_row += of_line.in_row / kRounds;
    lines.next_row += of_line.next_row / kRounds;
    waves.in_row += of_wave.in_row / kRounds;
    waves.next_row += of_wave.next_row / kRounds;
  }
  EXPECT_GT(lines.in_row, 0.4);
  EXPECT_NEAR(lines.next_row, 0, 0.1);
  EXPECT_GT(waves.in_row, 0.4);
  EXPECT_GT(waves.next_row, 0.5 * waves.in_row);
}

TEST(Scatter, BesideAPointOfOneSheetLieSomeOfTheOther) {
  std::mt19937_64 engine(9);
  std::bernoulli_distribution above;
  constexpr int kRounds = 200;
  double sheets = 0;
  for (int round = 0; round < kRounds; ++round)
    sheets += middle_fit(100, [&](const auto&) { return above(engine) ? 0.01 : -0.01; }).beside / kRounds;
  EXPECT_NEAR(sheets, 1, 0.25);
}

// Rows of a grid that lie to one side and the other in turns: none is beside one of the other side.
TEST(Scatter, BesideARowIsNoneOfTheOtherSide) {
  Positions points;
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j) points.emplace_back(i, j, i % 2 == 0 ? 0.5 : -0.5);
  const rfs_mesh::SpatialIndex index(points, {});
  rfs_mesh::KeptNeighbors kept(0);
  EXPECT_EQ(rfs_mesh::ScatterFit()(index, Eigen::Vector3d(0.3, 0.2, 0), 100, 0, kept).beside, 0);
}

TEST(Scatter, VarianceIsThatOffAQuadric) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0, 0.01);
  EXPECT_NEAR(std::sqrt(middle_fit(1000, [&](const auto&) { return normal(engine); }).variance), 0.01, 6e-4);
  EXPECT_NEAR(std::sqrt(middle_fit(100, [](const auto&) { return 0; }).variance), 0, 2e-3);
}

}  // namespace
