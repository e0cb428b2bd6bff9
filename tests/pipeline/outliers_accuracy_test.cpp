/// Strays are found; nothing of a clean or a merely noisy cloud is called one.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "clouds/scanner/scanner.h"
#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "tests/pipeline/support/found_outliers.h"

namespace rfsmooth::pipeline {
namespace {

using outliers::count;
using outliers::find;
using outliers::grid;
using outliers::noisy;

Positions random_plane(std::size_t n, double power) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform;
  Positions points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = std::pow(uniform(engine), power);
    points.emplace_back(x, uniform(engine), 0);
  }
  return points;
}

TEST(Outliers, CleanCloudsHaveNone) {
  EXPECT_EQ(count(find(grid(30, 30, 1))), 0u) << "an open regular grid, rims and corners";
  EXPECT_EQ(count(find(grid(30, 30, 5))), 0u) << "rows farther apart than their points";
  EXPECT_EQ(count(find(grid(30, 30, 20))), 0u) << "scan lines";
  EXPECT_EQ(count(find(random_plane(1200, 1))), 0u);
  EXPECT_EQ(count(find(random_plane(1200, 3))), 0u) << "a density gradient";
  for (const char* shape : {"sphere", "cube", "l_part", "plate", "wavy_sheet", "two_density_sphere"})
    EXPECT_EQ(count(find(clouds::sample(*clouds::make_shape(shape), 1200, 1))), 0u) << shape;
}

TEST(Outliers, SparsePartsAndThinPartsAreNoOutliers) {
  Positions two = clouds::sample(*clouds::make_sphere(), 4000, 1), small;
  for (const auto& p : clouds::sample(*clouds::make_sphere(), 60, 2))
    small.push_back(p + Eigen::Vector3d(5, 0, 0));
  two.insert(two.end(), small.begin(), small.end());
  EXPECT_EQ(count(find(two)), 0u) << "two clusters, one 67 times thinner";
  EXPECT_EQ(count(find(clouds::sample(*clouds::make_plate(0.01), 4000, 1))), 0u);
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform;
  Positions helix, cone;
  for (int i = 0; i < 4000; ++i) {
    const double t = 50 * uniform(engine), z = uniform(engine);
    helix.emplace_back(std::cos(t), std::sin(t), 0.1 * t);
    cone.emplace_back(0.1 * z * std::cos(t), 0.1 * z * std::sin(t), z);
  }
  EXPECT_EQ(count(find(helix)), 0u) << "a wire";
  EXPECT_EQ(count(find(cone)), 0u) << "a needle";
}

TEST(Outliers, GaussianNoiseHasNearlyNone) {
  // Every shape and every noise, and the two shapes that have the most in them under two noises.
  const std::pair<const char*, double> clouds[] = {{"sphere", 1.0}, {"l_part", 0.3}, {"l_part", 3.0},
                                                   {"plate", 0.3},  {"plate", 1.0},  {"wavy_sheet", 3.0}};
  for (const auto& [shape, spacings] : clouds) {
    const Positions clean = clouds::sample(*clouds::make_shape(shape), 4000, 1);
    EXPECT_LE(count(find(noisy(clean, spacings))), 1u) << shape << " at " << spacings;
  }
}

/// Strays in the box around a shape: those that lie beyond six sigma and four spacings must be found.
TEST(Outliers, StraysAreFound) {
  constexpr std::size_t kPoints = 5000;
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<double> uniform(-1.2, 1.2);
  const std::pair<const char*, std::vector<double>> noises[] = {
      {"sphere", {0.0, 1.0}}, {"torus", {0.5}}, {"l_part", {0.0, 1.0}}};
  for (const auto& [name, of_shape] : noises) {
    const auto shape = clouds::make_shape(name);
    for (const double spacings : of_shape) {
      Positions points = clouds::sample(*shape, kPoints, 1);
      const double spacing = clouds::mean_spacing(points);
      points = noisy(points, spacings);
      std::size_t far = 0, found = 0;
      for (int i = 0; i < 80; ++i) points.emplace_back(uniform(engine), uniform(engine), uniform(engine));
      const std::vector<char> flags = find(points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double distance = std::abs(shape->signed_distance(points[i]));
        if (i < kPoints) {
          EXPECT_EQ(flags[i], 0) << name << " at " << spacings << ": point " << i;
          continue;
        }
        if (distance < std::max(4.0, 6 * spacings) * spacing) continue;
        ++far;
        found += std::size_t(flags[i]);
      }
      EXPECT_GT(far, 20u);
      EXPECT_GE(double(found), 0.85 * double(far)) << name << " at " << spacings;
    }
  }
}

/// Returns that lie between two surfaces because the beam met both.
TEST(Outliers, MixedPixelsAreFound) {
  clouds::ScannerOptions options;
  options.views = 4;
  options.noise = 0.004;
  options.beam = 0.8;
  for (const char* name : {"torus", "l_part"}) {
    Positions points;
    std::vector<char> mixed, surface;
    for (const auto& seen : clouds::scan(*clouds::make_shape(name), options, 1, {})) {
      if (seen.kind == clouds::ReturnKind::none) continue;
      points.push_back(seen.measured);
      surface.push_back(seen.kind == clouds::ReturnKind::surface);
      mixed.push_back(seen.kind == clouds::ReturnKind::mixed && (seen.measured - seen.truth).norm() > 0.15);
    }
    const std::vector<char> flags = find(points);
    std::size_t right = 0, wrong = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      right += std::size_t(flags[i] != 0 && mixed[i] != 0);
      wrong += std::size_t(flags[i] != 0 && surface[i] != 0);
    }
    EXPECT_GT(count(mixed), 20u) << name;
    EXPECT_GE(double(right), 0.7 * double(count(mixed))) << name;
    EXPECT_LE(wrong, points.size() / 2000) << name;
  }
}

}  // namespace
}  // namespace rfsmooth::pipeline
