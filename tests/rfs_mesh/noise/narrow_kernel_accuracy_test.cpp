/// The measure of noise on solids of a few sigma, which narrow kernels bound.
#include <gtest/gtest.h>

#include "rfs_mesh/noise/noise.h"
#include "tests/rfs_mesh/noise/noisy_solids.h"

using namespace rfsmooth;
using rfs_mesh::SpatialIndex;

namespace {

using test::kNoiseInSlab;
using test::noisy;
using test::rod;
using test::stack;

// Windows alone took it for 2.9 and 1.5 times as much, and smoothed stacks to less than they were.
TEST(NarrowKernel, BoundsTheWholeMeasureOnStacksAndRods) {
  const auto measured = [](const Positions& points) {
    const Context context;
    return rfs_mesh::measure_noise(SpatialIndex(points, context), context).sigma / kNoiseInSlab;
  };
  EXPECT_NEAR(measured(noisy(24000, [](double u, double v) { return stack(5, 3 * kNoiseInSlab, u, v); })),
              1.3, 0.3);
  EXPECT_NEAR(measured(noisy(10000, [](double u, double v) { return rod(1.5 * kNoiseInSlab, u, v); })), 1.2,
              0.2);
  // Noise of 0.8 spacings, which windows alone took for 2.8 times as much.
  EXPECT_NEAR(measured(noisy(1972, [](double u, double v) { return stack(3, 3.5 * kNoiseInSlab, u, v); })),
              1.3, 0.3);
}

}  // namespace
