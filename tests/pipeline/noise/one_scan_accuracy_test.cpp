/// What `denoise` makes of one scan whose rows or points lie to two sides or are each off by themselves, of
/// two scans, of little noise, and of waves.
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "tests/pipeline/noise/noisy_sphere.h"

using namespace rfsmooth;
using namespace rfsmooth::noisy;

namespace {

constexpr int kRows = 100;

/// Hills so wide that heights are distances.
double hills(double x, double y) {
  return 2 * std::sin(x / 25) * std::cos(y / 30);
}

double off_hills(const Eigen::Vector3d& p) {
  return p.z() - hills(p.x(), p.y());
}

/// A grid of points one apart, with noise; each is off by `offset` of its row and column.
Positions scan(const std::function<double(int, int)>& offset) {
  std::mt19937_64 engine(6);
  std::normal_distribution<double> normal(0, 0.12);
  Positions points;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kRows; ++column)
      points.emplace_back(column, row, hills(column, row) + offset(row, column) + normal(engine));
  return points;
}

// Two laser heads, or a mirror that swings both ways: no two sheets are scanned so that beside a point of one
// there is never one of the other.
TEST(OneScan, WhoseRowsAlternateBecomesOneSurface) {
  for (const double off : {0.35, 0.45, 0.6}) {
    const Positions rows = scan([&](int row, int) { return row % 2 == 0 ? off : -off; });
    EXPECT_LT(rms(denoised(rows), off_hills), 0.2 * rms(rows, off_hills)) << off;
  }
}

TEST(OneScan, WhosePointsAlternateBecomesOneSurface) {
  const Positions points = scan([](int row, int column) { return (row + column) % 2 == 0 ? 0.45 : -0.45; });
  EXPECT_LT(rms(denoised(points), off_hills), 0.2 * rms(points, off_hills));
}

// The lasers of a scanner, each off by four times what a point is: a quadric follows three rings.
TEST(OneScan, WhoseRingsAreEachOffBecomesOneSurface) {
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal;
  Positions rings;
  for (int ring = 0; ring < 60; ++ring) {
    const double off = 0.8 * normal(engine), y = 2.3 * ring;
    for (int i = 0; i < 200; ++i) rings.emplace_back(i, y, hills(i, y) + off + 0.2 * normal(engine));
  }
  EXPECT_LT(rms(denoised(rings), off_hills), 0.55 * rms(rings, off_hills));
}

// Waves that points resolve are no such rings.
TEST(OneScan, OfWavesUnderNoiseKeepsThem) {
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal(0, 0.3);
  const auto waves = [](double x, double y) {
    return hills(x, y) + 0.6 * std::sin(2 * M_PI / 8 * (x + 0.3 * y));
  };
  Positions points;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kRows; ++column)
      points.emplace_back(column, row, waves(column, row) + normal(engine));
  const auto off_waves = [&](const Eigen::Vector3d& p) { return p.z() - waves(p.x(), p.y()); };
  EXPECT_LT(rms(denoised(points), off_waves), 0.6 * rms(points, off_waves));
}

// A precise scanner, or a scan of which few points are left: less than a twentieth of a spacing.
TEST(OneScan, WithLittleNoiseIsSmoothed) {
  Positions points;
  std::mt19937_64 engine(10);
  std::normal_distribution<double> normal(0, 0.03);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kRows; ++column)
      points.emplace_back(column, row, hills(column, row) + normal(engine));
  EXPECT_LT(rms(denoised(points), off_hills), 0.4 * rms(points, off_hills));
}

// About the same offsets of two scans, each a grid of its own, are the sides of a plate.
TEST(OneScan, OfEitherSideOfAPlateIsKeptApart) {
  constexpr double kHalf = 0.65;
  const double turn = 0.4;
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0, 0.12);
  Positions plate;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kRows; ++column) {
      const double x = 1.4 * column, y = 1.4 * row;
      plate.emplace_back(x, y, kHalf + normal(engine));
      plate.emplace_back(std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y,
                         -kHalf + normal(engine));
    }
  const auto off_plate = [](const Eigen::Vector3d& p) { return std::abs(p.z()) - kHalf; };
  EXPECT_LT(rms(denoised(plate), off_plate), rms(plate, off_plate));
}

}  // namespace
