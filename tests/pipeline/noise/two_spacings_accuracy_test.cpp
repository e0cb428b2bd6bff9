/// What `denoise` makes of two things in one cloud whose points are five times as far apart and more on one
/// of them as on the other.
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/pipeline/noise/noisy_sphere.h"

using namespace rfsmooth;
using namespace rfsmooth::noisy;

namespace {

/// A box, points at random on it, and their noise in mean distances to their nearest.
struct Box {
  std::size_t points;
  double noise, times;  ///< how large it is beside `kHalf`
  double x;             ///< of its middle

  static inline const Eigen::Array3d kHalf = {1, 0.5, 0.2};  ///< of its edges

  double spacing() const {
    const Eigen::Array3d h = times * kHalf;
    return 0.5 * std::sqrt(8 * (h[0] * h[1] + h[1] * h[2] + h[2] * h[0]) / double(points));
  }
  double off(const Eigen::Vector3d& p) const {
    const Eigen::Array3d beyond = (p - Eigen::Vector3d(x, 0, 0)).array().abs() - times * kHalf;
    return (beyond.maxCoeff() > 0 ? beyond.max(0).matrix().norm() : beyond.maxCoeff()) / spacing();
  }
};

Positions scan_of(const Box& box, std::mt19937_64& engine) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  const Eigen::Array3d area = Box::kHalf.prod() / Box::kHalf;
  std::discrete_distribution<int> face({area[0], area[1], area[2]});
  Positions scan;
  for (std::size_t i = 0; i < box.points; ++i) {
    Eigen::Array3d at(uniform(engine), uniform(engine), uniform(engine));
    const int axis = face(engine);
    at[axis] = at[axis] > 0 ? 1 : -1;
    at *= box.times * Box::kHalf;
    const double off = box.noise * box.spacing() * normal(engine);
    scan.emplace_back(at.matrix() + Eigen::Vector3d(box.x, 0, 0) + off * Eigen::Vector3d::Unit(axis));
  }
  return scan;
}

/// How far the points are off two boxes before and after, each in its own spacings.
struct TwoBoxes {
  TwoBoxes(const Box& one, const Box& other) {
    std::mt19937_64 engine(5);
    Positions points = scan_of(one, engine), more = scan_of(other, engine);
    points.insert(points.end(), more.begin(), more.end());
    const auto seen = [&](const Box& box, std::size_t from) {
      const auto first = points.begin() + std::ptrdiff_t(from);
      return rms(Positions(first, first + std::ptrdiff_t(box.points)),
                 [&](const Eigen::Vector3d& p) { return box.off(p); });
    };
    before = {seen(one, 0), seen(other, one.points)};
    report = denoise(points);
    after = {seen(one, 0), seen(other, one.points)};
  }
  std::array<double, 2> before{}, after{};
  DenoiseReport report;
};

TEST(TwoSpacings, ANoisyThingIsSmoothedBesideAnExactOneOfFiveTimesTheSpacing) {
  const TwoBoxes boxes({6000, 0.7, 1, 0}, {6000, 0, 5, 7});
  EXPECT_FALSE(boxes.report.not_smoothed);
  EXPECT_LT(boxes.after[0], 0.4 * boxes.before[0]);
  EXPECT_LT(boxes.after[1], 0.05);
}

TEST(TwoSpacings, EachHasItsOwnNoise) {
  for (const double times : {6.0, 20.0}) {
    const TwoBoxes boxes({6000, 0.5, 1, 0}, {6000, 0.5, times, 1.5 * times});
    for (const std::size_t k : {0, 1}) EXPECT_LT(boxes.after[k], 0.3 * boxes.before[k]) << times << ' ' << k;
  }
}

// Its noise is a seventh of a spacing, and that of the other one and a half: 75 times as much.
TEST(TwoSpacings, ASmallThingBeforeALoudAndSparseOneStaysAsGoodAsItWas) {
  const TwoBoxes boxes({2500, 0.1, 0.1, 0}, {25000, 1.5, 10, 12});
  EXPECT_LT(boxes.after[0], boxes.before[0]);
  EXPECT_LT(boxes.after[1], 0.2 * boxes.before[1]);
}

// Ghosts of a scanner, all over the space around what it saw. They have no surface to go to.
TEST(TwoSpacings, StraysAllOverAVolumeStayWhereTheyAre) {
  constexpr std::size_t kBox = 10000;
  const Box box{kBox, 0.4, 1, 0};
  for (const double wide : {10.0, 60.0}) {
    std::mt19937_64 engine(8);
    std::uniform_real_distribution<double> uniform(-wide, wide);
    Positions points = scan_of(box, engine);
    for (int i = 0; i < 600; ++i) points.emplace_back(uniform(engine), uniform(engine), uniform(engine));
    const Positions smooth = denoised(points);
    for (std::size_t i = kBox; i < points.size(); ++i)
      ASSERT_LT((smooth[i] - points[i]).norm(), 0.1) << i << ' ' << wide;
    const auto of_box = [&](const Positions& all) {
      return rms({all.begin(), all.begin() + kBox}, [&](const Eigen::Vector3d& p) { return box.off(p); });
    };
    EXPECT_LT(of_box(smooth), 0.4 * of_box(points)) << wide;
  }
}

// So few that they are no part of the cloud, in a column above it, as fog and birds before a laser.
TEST(TwoSpacings, AFewStraysAboveTheGroundStayWhereTheyAre) {
  constexpr std::size_t kGround = 34000;
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::normal_distribution<double> normal(0, 0.006);
    Positions points;
    for (std::size_t i = 0; i < kGround; ++i)
      points.emplace_back(3 * uniform(engine), 3 * uniform(engine), normal(engine));
    for (int i = 0; i < 200; ++i)
      points.emplace_back(4 * uniform(engine), 4 * uniform(engine), 42.5 + 37.5 * uniform(engine));
    const Positions smooth = denoised(points);
    for (std::size_t i = kGround; i < points.size(); ++i)
      ASSERT_LT((smooth[i] - points[i]).norm(), 0.1) << i << ' ' << seed;
  }
}

// The statistics tell the parts, and give the same bytes when they are used again.
TEST(TwoSpacings, StatisticsOfPartsGiveTheBytesOfTheRunAgain) {
  std::mt19937_64 engine(6);
  Positions points = scan_of({3000, 0.5, 1, 0}, engine);
  const Positions more = scan_of({3000, 0.5, 10, 13}, engine);
  points.insert(points.end(), more.begin(), more.end());
  Positions once = points, again = points;
  const DenoiseReport report = denoise(once);
  EXPECT_EQ(report.statistics.parts.size(), 2U);
  DenoiseOptions options;
  options.statistics = report.statistics;
  ASSERT_TRUE(rfsmooth::denoise(again.front().data(), again.size(), options, {}));
  EXPECT_EQ(once, again);
}

}  // namespace
