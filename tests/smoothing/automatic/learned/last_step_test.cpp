#include "smoothing/automatic/learned/last_step.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/connect.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "smoothing/automatic/flow_auto.h"
#include "smoothing/automatic/learned/network.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

constexpr double kSigma = 0.05;

/// A ring whose tube has a radius of 1.6 sigma, or one that is thick.
constexpr double kLimb = 0.08, kThick = 0.4;

/// A ring's cloud with noise, as a rough mesh.
Mesh noisy_ring(double tube) {
  Positions points = clouds::sample(*clouds::make_torus(1, tube), 5000, 3);
  clouds::add_noise(points, kSigma, 4);
  return value_or_throw(connect(points, {}, {})).mesh;
}

double mean_square(const Positions& points, double tube) {
  const auto ring = clouds::make_torus(1, tube);
  double sum = 0;
  for (const auto& p : points) sum += std::pow(ring->signed_distance(p), 2);
  return sum / double(points.size());
}

Positions smoothed(Mesh mesh, bool learned, double sigma = kSigma, const Context& context = {}) {
  AutomaticOptions options;
  options.noise = Length{sigma, false};
  options.learned = learned;
  Statistics settled;
  settled.sheets = Statistics::Sheets{0, 1};  // no hidden walls: the step is all there is
  smooth_automatically(mesh, options, context, Connectivity::kept, nullptr, &settled);
  return mesh.positions;
}

TEST(LearnedStep, IsOddInTheNormal) {
  Features::Row row;
  clouds::Random random(1);
  for (float& x : row.even) x = float(random.uniform(0, 1));
  for (float& x : row.odd) x = float(random.normal());
  const Network network;
  const float offset = network.offset(row);
  for (float& x : row.odd) x = -x;
  EXPECT_NE(offset, 0);
  EXPECT_EQ(network.offset(row), -offset);
  row.odd.fill(0);
  EXPECT_EQ(network.offset(row), 0);
}

TEST(LearnedStep, BringsThePointsOfLimbsNearerToTheirSurface) {
  const Mesh mesh = noisy_ring(kLimb);
  EXPECT_LT(mean_square(smoothed(mesh, true), kLimb), 0.8 * mean_square(smoothed(mesh, false), kLimb));
}

TEST(LearnedStep, DoesThickPartsNoHarm) {
  const Mesh mesh = noisy_ring(kThick);
  const Positions with = smoothed(mesh, true), without = smoothed(mesh, false);
  EXPECT_FALSE(with == without) << "the step was not taken";
  EXPECT_LT(mean_square(with, kThick), 1.02 * mean_square(without, kThick));
}

TEST(LearnedStep, TurnsAndGrowsWithTheCloud) {
  const Mesh mesh = noisy_ring(kLimb);
  const Eigen::Affine3d motion = Eigen::Translation3d(3, -2, 1) *
                                 Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()) *
                                 Eigen::Scaling(20.0);
  Mesh moved = mesh;
  for (auto& p : moved.positions) p = motion * p;
  const Positions here = smoothed(mesh, true), there = smoothed(moved, true, 20 * kSigma);
  std::size_t off = 0;
  for (std::size_t i = 0; i < here.size(); ++i)
    off += (motion * here[i] - there[i]).norm() > 0.02 * 20 * kSigma;
  // Where rounding decides on a patch, so it does on the points of this patch, some fifty.
  EXPECT_LT(off, here.size() / 50);
}

TEST(LearnedStep, IsTheSameForAnyNumberOfThreads) {
  const Mesh mesh = noisy_ring(kLimb);
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  EXPECT_EQ(smoothed(mesh, true, kSigma, one), smoothed(mesh, true, kSigma, three));
}

// A block with a fin whose two sheets are 1.6 sigma apart.
TEST(LearnedStep, GoesOnFromHiddenWallsThatWereParted) {
  const std::string fin(44, '#'), block = std::string(14, '#') + std::string(30, '.');
  std::vector<std::string_view> plan(14, block);
  plan.front() = fin;
  const auto part = clouds::make_prism(plan, 1.6 * kSigma, 1.2);
  Positions points = clouds::sample(*part, 16000, 3);
  clouds::add_noise(points, kSigma, 4);
  const Mesh mesh = value_or_throw(connect(points, {}, {})).mesh;
  const auto mean_square = [&](bool learned) {
    Mesh smooth = mesh;
    AutomaticOptions options;
    options.noise = Length{kSigma, false};
    options.learned = learned;
    Statistics settled;
    smooth_automatically(smooth, options, {}, Connectivity::kept, nullptr, &settled);
    EXPECT_GT(settled.sheets->evidence, 2);
    double sum = 0;
    for (const auto& p : smooth.positions) sum += std::pow(part->signed_distance(p), 2);
    return sum / double(points.size());
  };
  EXPECT_LT(mean_square(true), 0.9 * mean_square(false));
}

TEST(LearnedStep, LeavesLittleNoiseAlone) {
  Mesh with = noisy_ring(kLimb), without = with;
  AutomaticOptions options;
  options.noise = Length{0.1, true};
  const auto report = smooth_automatically(with, options, {});
  EXPECT_GT(report->guide_strength, 0);
  options.learned = false;
  smooth_automatically(without, options, {});
  EXPECT_EQ(with.positions, without.positions);
}

}  // namespace
