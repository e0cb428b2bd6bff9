#include "smoothing/automatic/learned/last_step.h"

#include <cstddef>
#include <cstdint>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "clouds/shapes/sampling.h"
#include "smoothing/automatic/learned/network.h"
#include "tests/smoothing/automatic/learned/noisy_ring.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

using test::kLimb;
using test::kSigma;
using test::noisy_ring;
using test::smoothed;

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

// Where rounding decides on a patch, so it does on the points of this patch, some fifty. In the second of the
// rings it decides on one that a sixth of the points follow.
TEST(LearnedStep, TurnsAndGrowsWithTheCloud) {
  const Eigen::Affine3d motion = Eigen::Translation3d(3, -2, 1) *
                                 Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()) *
                                 Eigen::Scaling(20.0);
  int turned = 0;
  for (const std::uint64_t seed : {2U, 3U, 4U, 5U, 6U}) {
    const Mesh mesh = noisy_ring(kLimb, seed);
    Mesh moved = mesh;
    for (auto& p : moved.positions) p = motion * p;
    const Positions here = smoothed(mesh, true), there = smoothed(moved, true, 20 * kSigma);
    std::size_t off = 0;
    for (std::size_t i = 0; i < here.size(); ++i)
      off += (motion * here[i] - there[i]).norm() > 0.02 * 20 * kSigma;
    EXPECT_LT(off, here.size() / 5) << seed;
    turned += off < here.size() / 50;
  }
  EXPECT_GE(turned, 4);
}

TEST(LearnedStep, IsTheSameForAnyNumberOfThreads) {
  const Mesh mesh = noisy_ring(kLimb);
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  EXPECT_EQ(smoothed(mesh, true, kSigma, one), smoothed(mesh, true, kSigma, three));
}

}  // namespace
