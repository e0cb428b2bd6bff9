/// How much nearer to their surface the learned step brings points, and where it is not taken.
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include <rfsmooth/connect.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "smoothing/automatic/flow_auto.h"
#include "tests/smoothing/automatic/learned/noisy_ring.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

using test::kLimb;
using test::kSigma;
using test::noisy_ring;
using test::smoothed;

/// The radius of a tube that is thick for the noise.
constexpr double kThick = 0.4;

double mean_square(const Positions& points, double tube) {
  const auto ring = clouds::make_torus(1, tube);
  double sum = 0;
  for (const auto& p : points) sum += std::pow(ring->signed_distance(p), 2);
  return sum / double(points.size());
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
    smooth_automatically(smooth, options, {}, Connectivity::kept, &settled);
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
