/// How near the measured noise comes to the true one.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "rfs_mesh/noise/noise.h"
#include "tests/rfs_mesh/noise/measured_noise.h"
#include "tests/support/shapes.h"

using namespace rfsmooth;
using rfs_mesh::NoiseField;
using rfs_mesh::SpatialIndex;

namespace {

using test::kOfSphere;
using test::measured;
using test::noisy_plane;
using test::noisy_sphere;

TEST(Noise, IsMeasuredOnASphereFromATenthToTwoSpacings) {
  const double spacing = std::sqrt(4 * M_PI / kOfSphere);
  for (const bool isotropic : {true, false})
    for (const double share : {0.1, 0.3, 1.0, 2.0}) {
      const double sigma = share * spacing;
      const NoiseField noise = measured(noisy_sphere([&](const auto&) { return sigma; }, isotropic));
      EXPECT_NEAR(noise.sigma / sigma, 1, 0.15) << share << " spacings, isotropic " << isotropic;
    }
}

/// The noise measured away from the border of the halves of noisy_plane, over what is there.
std::array<double, 2> halves(double calm, double loud) {
  const NoiseField noise = measured(noisy_plane([&](double x) { return x < 0.5 ? calm : loud; }));
  const Positions points = noisy_plane([](double) { return 0; });
  std::array<double, 2> sum = {}, count = {};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(points[i].x() - 0.5) < 0.1) continue;
    const std::size_t half = points[i].x() < 0.5 ? 0 : 1;
    sum[half] += noise.local[i];
    ++count[half];
  }
  return {sum[0] / count[0] / calm, sum[1] / count[1] / loud};
}

TEST(Noise, OfOneHalfOfAPlaneIsSeenThereAndNotInTheOther) {
  const auto [calm, loud] = halves(0.002, 0.006);
  EXPECT_NEAR(calm, 1, 0.15);
  EXPECT_NEAR(loud, 1, 0.15);
}

// The figure is between what the halves have.
TEST(Noise, OfAHalfThatIsSixTimesAsLoudAsTheOtherIsSeenInBoth) {
  const auto [calm, loud] = halves(0.001, 0.006);
  EXPECT_NEAR(calm, 1, 0.15);
  EXPECT_NEAR(loud, 1, 0.15);
}

TEST(Noise, OfAHalfThatIsTwentyTimesAsLoudAsTheOtherIsSeenWhole) {
  const auto [calm, loud] = halves(0.001, 0.02);
  EXPECT_NEAR(calm, 1, 0.15);
  EXPECT_NEAR(loud, 1, 0.15);
}

// Windows made for the calm part leave nothing of the loud one.
TEST(Noise, OfALoudFifthOfABumpySheetIsSeenThere) {
  constexpr double kSigma = 0.0042;  // 0.6 spacings
  for (const unsigned seed : {1U, 2U}) {
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::normal_distribution<double> normal(0, kSigma);
    Positions points;
    for (int i = 0; i < 20000; ++i) {
      const double x = uniform(engine), y = uniform(engine);
      const double bump = 0.02 * std::sin(30 * x) * std::sin(30 * y);
      points.emplace_back(x, y, bump + (x > 0.6 ? normal(engine) : 0));
    }
    const NoiseField noise = measured(points);
    double calm = 0, loud = 0, calm_points = 0, loud_points = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double x = points[i].x(), v = noise.local[i] * noise.local[i];
      if (x > 0.65) loud += v, ++loud_points;
      if (x < 0.4) calm += v, ++calm_points;
    }
    EXPECT_NEAR(std::sqrt(loud / loud_points) / kSigma, 0.9, 0.25) << seed;  // along z, not the normal
    EXPECT_LT(std::sqrt(calm / calm_points), 0.1 * kSigma) << seed;
  }
}

TEST(Noise, OfEvenNoiseTheFieldIsNearlyConstant) {
  const NoiseField noise = measured(noisy_plane([](double) { return 0.005; }));
  ASSERT_FALSE(noise.local.empty());
  for (const double sigma : noise.local) EXPECT_NEAR(sigma / 0.005, 1, 0.35);
  std::size_t near = 0;
  for (const double sigma : noise.local) near += std::abs(sigma / 0.005 - 1) < 0.12 ? 1 : 0;
  EXPECT_GT(double(near), 0.8 * double(noise.local.size()));
}

TEST(Noise, OfTheLoudHalfOfAThinWallIsNotItsThickness) {
  // Sheets as near as neighbours, exact in one half: windows open from zero in the other, and must stop
  // before they hold both sheets.
  constexpr double kLoud = 0.003;
  const auto sigma = [](double x) { return x < 0.5 ? 0 : kLoud; };
  Positions points = noisy_plane(sigma);
  for (auto& p : noisy_plane(sigma)) points.emplace_back(p.x(), 1 - p.y(), 0.015 + p.z());
  const NoiseField noise = measured(points);
  ASSERT_EQ(noise.local.size(), points.size());
  double sum = 0, loud = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].x() < 0.6) continue;
    sum += noise.local[i] / kLoud;
    ++loud;
  }
  EXPECT_NEAR(sum / loud, 1, 0.3);
}

TEST(Noise, OfAnEvenDistributionIsItsDeviation) {
  // Its residuals are nearly as flat as those of two sheets, but fill their middle.
  std::mt19937_64 engine(8);
  std::uniform_real_distribution<double> even(-0.004, 0.004);
  Positions points = noisy_plane([](double) { return 0; });
  for (auto& p : points) p.z() = even(engine);
  EXPECT_NEAR(measured(points).sigma * std::sqrt(3.0) / 0.004, 1, 0.15);
}

/// A depth image of 84 x 84 points a unit apart: a curved surface with normal noise, depths in steps.
Positions depth_image(double slope, double step, double sigma) {
  std::mt19937_64 engine(6);
  std::normal_distribution<double> normal;
  Positions points;
  constexpr int kSide = 84, kMiddle = kSide / 2;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const double bow = 0.002 * ((i - kMiddle) * (i - kMiddle) + (j - kMiddle) * (j - kMiddle));
      const double z = slope * i + 0.03 * j + bow + sigma * normal(engine);
      points.emplace_back(i, j, step * std::round(z / step));
    }
  return points;
}

TEST(Noise, OfDepthsInStepsIsTheirRoundingToo) {
  // Around most points the sixteen nearest lie on one step or two: within a step there is no noise at all.
  for (const double step : {0.5, 1.2})
    for (const double slope : {0.02, 0.1, 0.5}) {
      const double truth = std::hypot(step / 4, step / std::sqrt(12)) / std::sqrt(1 + slope * slope);
      const NoiseField noise = measured(depth_image(slope, step, step / 4));
      EXPECT_LT(noise.sigma / truth, 1.2) << step << " " << slope;
      EXPECT_GT(noise.sigma / truth, 0.65) << step << " " << slope;
    }
}

TEST(Noise, OfDepthsInStepsIsTheSameWhereTheCloudWasTurned) {
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(1.1F, Eigen::Vector3f(1, 2, -1).normalized()).toRotationMatrix();
  for (const double slope : {0.02, 0.1}) {
    const Positions points = depth_image(slope, 0.5, 0.125);
    Positions there;
    for (const auto& p : points) there.push_back((turn * p.cast<float>()).cast<double>());
    const double here = measured(points).sigma;
    EXPECT_NEAR(measured(there).sigma / here, 1, 0.02) << slope;
  }
}

TEST(Noise, OfScanLinesRoundedToTenthsIsThatAcrossThem) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  for (const double sigma : {0.05, 0.2}) {
    Positions points;
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < 200; ++j) {
        Eigen::Vector3d p(1.5 * i, 0.3 * j, 0.0001 * j * j + sigma * normal(engine));
        for (int axis = 0; axis < 3; ++axis) p[axis] = 0.1 * std::round(10 * p[axis]);
        points.push_back(p);
      }
    EXPECT_NEAR(measured(points).sigma / std::hypot(sigma, 0.1 / std::sqrt(12)), 1, 0.2) << sigma;
  }
}

TEST(Noise, IsOfTheSurfaceNotOfWhereThePointsAre) {
  // A third of the points within two spacings, as beside a scanner, and without noise.
  Positions points = noisy_plane([](double) { return 0.0015; });
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> offset(2, 2.02);
  for (int i = 0; i < 5000; ++i) points.emplace_back(offset(engine), offset(engine), 0);
  EXPECT_NEAR(measured(points).sigma / 0.0015, 1, 0.2);
}

TEST(Noise, OfTwoCleanSheetsTwoSpacingsApartIsNotTheirDistance) {
  Positions points = noisy_plane([](double) { return 0; });
  for (const auto& p : noisy_plane([](double) { return 0; })) points.emplace_back(p.y(), p.x(), 0.02);
  EXPECT_LT(measured(points).sigma, 0.0005);
}

/// A share of the points of a bumpy sheet's far half lies `gap` higher, as of a second scan; spacing 1.
/// Returns the noise of the halves, away from where they meet.
std::array<double, 2> of_two_scans(double share, double gap, double sigma, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal(0, sigma);
  Positions points;
  constexpr int kSide = 96, kMiddle = kSide / 2;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const double x = i + 0.8 * uniform(engine), y = j + 0.8 * uniform(engine);
      const double bump = 2 * std::sin(x / 10) * std::sin(y / 10);
      const bool second = x > kMiddle && uniform(engine) < share;
      points.emplace_back(x, y, bump + normal(engine) + (second ? gap : 0));
    }
  const NoiseField noise = measured(points);
  std::array<double, 2> squares = {}, count = {};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(points[i].x() - kMiddle) < 10) continue;
    const std::size_t half = points[i].x() < kMiddle ? 0 : 1;
    squares[half] += noise.local[i] * noise.local[i];
    ++count[half];
  }
  return {std::sqrt(squares[0] / count[0]), std::sqrt(squares[1] / count[1])};
}

TEST(Noise, OfTwoScansNearerToEachOtherThanTheirPointsIsTheirScatter) {
  constexpr double kShare = 0.35, kGap = 0.75, kSigma = 0.05;
  const double scatter = std::sqrt(kShare * (1 - kShare)) * kGap;
  for (const unsigned seed : {1U, 2U}) {
    const auto [one, two] = of_two_scans(kShare, kGap, kSigma, seed);
    EXPECT_LT(one, 2 * kSigma) << seed;
    EXPECT_NEAR(two / scatter, 1, 0.25) << seed;
  }
}

// As many points on each, as where two strips of a flight overlap; farther apart they may be a plate's sides.
TEST(Noise, OfTwoScansWithAsManyPointsIsTheirScatterWhereTheyAreNearer) {
  constexpr double kSigma = 0.05;
  for (const unsigned seed : {1U, 2U}) {
    EXPECT_NEAR(of_two_scans(0.5, 0.35, kSigma, seed)[1] / (0.5 * 0.35), 1, 0.25) << seed;
    EXPECT_LT(of_two_scans(0.5, 1.5, kSigma, seed)[1], 3 * kSigma) << seed;
  }
}

TEST(Noise, OfTwoScansThreeSpacingsApartIsThatOfEach) {
  const auto [one, two] = of_two_scans(0.35, 3, 0.05, 1);
  EXPECT_LT(one, 0.1);
  EXPECT_LT(two, 0.1);
}

constexpr int kOfSquare = 40000;
constexpr double kCell = 1.0 / 200;  // side of the square that has one of so many points

/// Random points of a square of side 1, at heights that `height` gives them.
Positions square(const std::function<double(double, double)>& height) {
  std::mt19937_64 engine(9);
  std::uniform_real_distribution<double> uniform;
  Positions points;
  for (int i = 0; i < kOfSquare; ++i) {
    const double x = uniform(engine), y = uniform(engine);
    points.emplace_back(x, y, height(x, y));
  }
  return points;
}

/// A square with noise that is the mean of that of the `shared` nearest, as large as sigma.
Positions square_with_shared_noise(int shared, double sigma) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(0, sigma);
  Positions points = square([](double, double) { return 0; });
  const SpatialIndex index(points, {});
  std::vector<double> own(points.size());
  for (double& z : own) z = normal(engine);
  std::vector<rfs_mesh::Neighbor> near;
  for (Eigen::Vector3d& p : points) {
    index.nearest(Eigen::Vector3d(p.x(), p.y(), 0), shared, near);
    for (const rfs_mesh::Neighbor& q : near) p.z() += own[q.index] / std::sqrt(shared);
  }
  return points;
}

TEST(Noise, ThatNeighboursShareIsSeenWholeAndCounted) {
  constexpr int kShared = 15;
  constexpr double kSigma = 0.6 * kCell;
  const NoiseField noise = measured(square_with_shared_noise(kShared, kSigma));
  EXPECT_NEAR(noise.sigma / kSigma, 1, 0.2);
  EXPECT_GT(noise.shared, kShared / 3.0);
  EXPECT_LT(noise.shared, kShared * 3.0);
}

// The narrowest neighbourhoods are inside of the slab that the points fill.
TEST(Noise, ThatNeighboursShareIsSeenAlsoWhereItIsLargerThanTheSpacing) {
  for (const double cells : {1.2, 2.4})
    for (const int shared : {3, 6}) {
      const double sigma = cells * kCell;
      const NoiseField noise = measured(square_with_shared_noise(shared, sigma));
      EXPECT_NEAR(noise.sigma / sigma, 1, 0.25) << sigma << ' ' << shared;
      EXPECT_GT(noise.shared, 1) << sigma << ' ' << shared;
    }
}

// Rounding to whole units makes exact planes of few points, which have no noise.
TEST(Noise, ThatNeighboursShareIsSeenInFewDecimalsToo) {
  const Positions points = square_with_shared_noise(30, 0.35 * kCell);
  const NoiseField noise = measured(points);
  ASSERT_GT(noise.shared, 10);
  for (const double unit : {0.1 * kCell, 0.3 * kCell}) {
    Positions rounded = points;
    for (Eigen::Vector3d& p : rounded) p = unit * (p / unit).array().round().matrix();
    EXPECT_NEAR(measured(rounded).sigma / noise.sigma, 1, 0.15) << unit / kCell;
  }
}

TEST(Noise, WithLoudPointsAmongTheOthersIsNotShared) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(0, 0.4 * kCell);
  std::bernoulli_distribution loud(0.2);
  const NoiseField noise =
      measured(square([&](double, double) { return (loud(engine) ? 4 : 1) * normal(engine); }));
  EXPECT_EQ(noise.shared, 1);
}

TEST(Noise, OfFewDepthsIsTheirRounding) {
  constexpr double kStep = 4 * kCell;  // terraces are twice as wide
  const auto depth = [](double x, double y) { return 0.5 * x + 0.1 * y; };
  const NoiseField noise =
      measured(square([&](double x, double y) { return kStep * std::round(depth(x, y) / kStep); }));
  EXPECT_NEAR(noise.step, kStep, 1e-12);
  const double along_normal = kStep / std::sqrt(12.0) / Eigen::Vector3d(0.5, 0.1, 1).norm();
  EXPECT_NEAR(noise.sigma / along_normal, 1, 0.2);
}

// As far from a camera: 192 points lie within a terrace.
TEST(Noise, OfTerracesWiderThanFitsIsTheirRoundingToo) {
  constexpr std::size_t kPoints = 40000;
  constexpr double kSpacing = 0.5 / 200, kStep = 4 * kSpacing, kSlope = 0.045;  // 90 spacings wide
  Positions points = test::random_points(test::plane(), kPoints, 3);
  for (auto& p : points) p.z() = kStep * std::round(kSlope * p.x() / kStep);
  const NoiseField noise = measured(points);
  EXPECT_NEAR(noise.step, kStep, 1e-12);
  EXPECT_GT(noise.sigma, 0.5 * kStep / std::sqrt(12.0));
  EXPECT_LT(noise.sigma, 1.2 * kStep / std::sqrt(12.0));
}

// Two sheets are farther apart than rounding explains.
TEST(Noise, OfAWallInFewDepthsIsTheirRounding) {
  constexpr std::size_t kPoints = 6000;
  const double spacing = 0.5 * std::sqrt(2.0 / kPoints);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.6, 0, 0.8), along(0.8, 0, -0.6);
  for (const double thickness : {1.5, 2.0})
    for (const double step : {1.0, 1.5}) {
      std::mt19937_64 engine(1);
      std::uniform_real_distribution<double> uniform(0, 1);
      Positions points;
      double rounding = 0;
      for (std::size_t i = 0; i < kPoints; ++i) {
        const double side = (i % 2 == 0 ? 0.5 : -0.5) * thickness * spacing;
        Eigen::Vector3d p =
            uniform(engine) * along + uniform(engine) * Eigen::Vector3d::UnitY() + side * normal;
        const double z = p.z();
        p.z() = step * spacing * std::round(z / (step * spacing));
        rounding += std::pow((p.z() - z) * normal.z(), 2) / kPoints;
        points.push_back(p);
      }
      EXPECT_NEAR(measured(points).sigma / std::sqrt(rounding), 1, 0.4) << thickness << ' ' << step;
    }
}

// The widest neighbourhoods that so few points allow are the only ones that see the steps.
TEST(Noise, OfASphereOfFewPointsInFewDepthsIsTheirRounding) {
  constexpr double kStep = 0.15;  // five spacings
  const test::Shape sphere = test::unit_sphere();
  for (const unsigned seed : {1U, 2U, 3U}) {
    Positions points = test::random_points(sphere, 3000, seed);
    double rounding = 0;
    for (Eigen::Vector3d& p : points) {
      p.z() = kStep * std::round(p.z() / kStep);
      rounding += std::pow(p.norm() - 1, 2) / 3000;
    }
    EXPECT_NEAR(measured(points).sigma / std::sqrt(rounding), 1, 0.25) << seed;
  }
}

TEST(Noise, OfRingsIsThatAcrossThem) {
  constexpr double kGap = 0.1, kStep = 0.005;  // twenty times farther apart than their points
  std::mt19937_64 engine(4);
  for (const double sigma : {0.0, 0.002}) {
    std::normal_distribution<double> normal(0, 1);
    Positions points;
    for (double y = 0; y < 2; y += kGap)
      for (double x = 0; x < 2; x += kStep) points.emplace_back(x, y, 0.1 * x * x + sigma * normal(engine));
    const NoiseField noise = measured(points);
    EXPECT_NEAR(noise.sigma, sigma, 0.2 * sigma + 1e-6);
    EXPECT_TRUE(noise.on_lines);
    EXPECT_GE(noise.piece, 64u) << "20 steps to the next ring on either side";
    EXPECT_EQ(noise.shared, 1);
  }
}

// A line of points that noise carries across it looks like a strip of a surface that contains the noise.
TEST(Noise, OfLinesIsThatAcrossThemWhereItIsSeveralOfTheirSteps) {
  constexpr double kStep = 0.005;
  for (const double gap : {9 * kStep, 20 * kStep})
    for (const double sigma : {2 * kStep, 4 * kStep}) {
      std::mt19937_64 engine(4);
      std::normal_distribution<double> normal(0, sigma);
      Positions points;
      for (double y = 0; y < 1.4; y += gap)
        for (double x = 0; x < 1.4; x += kStep) points.emplace_back(x, y, normal(engine));
      EXPECT_NEAR(measured(points).sigma / sigma, 1, 0.2) << gap << ' ' << sigma;
    }
}

}  // namespace
