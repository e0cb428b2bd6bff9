#include "rfs_mesh/noise/held_out.h"

#include <functional>
#include <optional>
#include <random>

#include <gtest/gtest.h>

using namespace rfsmooth;

namespace {

constexpr double kNoiseHeldOut = 0.02;  // about two spacings of what is below

/// 8,000 points of a unit square with isotropic noise. \param height of the surface that a point is of, by
/// where it is and a uniform number
Positions held_out_cloud(const std::function<double(double, double)>& height) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(0, kNoiseHeldOut);
  std::uniform_real_distribution<double> uniform;
  Positions points(8000);
  for (Eigen::Vector3d& p : points) {
    const double x = uniform(engine), y = uniform(engine), z = height(x, uniform(engine));
    p = {x + normal(engine), y + normal(engine), z + normal(engine)};
  }
  return points;
}

std::optional<double> held_out_bound_of(const Positions& points, double read, int threads = 0) {
  Context context;
  context.threads = threads;
  return rfs_mesh::held_out_bound(rfs_mesh::SpatialIndex(points, context), read, context);
}

double flat_sheet(double, double) {
  return 0;
}

/// Three of them, 4 sigma from each other.
double three_sheets(double, double any) {
  return 4 * kNoiseHeldOut * std::floor(3 * any);
}

TEST(HeldOut, OfASurfaceIsItsNoise) {
  for (const double times : {1.0, 1.3}) {
    const auto bound = held_out_bound_of(held_out_cloud(flat_sheet), times * kNoiseHeldOut);
    ASSERT_TRUE(bound);
    EXPECT_NEAR(*bound, kNoiseHeldOut, 0.06 * kNoiseHeldOut) << times;
  }
}

TEST(HeldOut, IsNoLessThanTheNoiseWhereQuadricsDoNotFollow) {
  const auto bound = held_out_bound_of(
      held_out_cloud([](double x, double) { return 0.05 * std::sin(40 * x); }), 1.5 * kNoiseHeldOut);
  ASSERT_TRUE(bound);
  EXPECT_GT(*bound, 0.95 * kNoiseHeldOut);
  EXPECT_LT(*bound, 1.4 * kNoiseHeldOut);
}

// All three within one slab would be noise of 3.4 sigma.
TEST(HeldOut, OfSheetsThatWereReadAsOneIsThatOfEach) {
  for (const double times : {1.3, 1.7}) {
    const auto bound = held_out_bound_of(held_out_cloud(three_sheets), times * kNoiseHeldOut);
    ASSERT_TRUE(bound);
    EXPECT_GT(*bound, 0.9 * kNoiseHeldOut) << times;
    EXPECT_LT(*bound, 1.2 * kNoiseHeldOut) << times;
  }
}

TEST(HeldOut, IsNoneWhereNoBallIsWideEnoughForTheNoise) {
  EXPECT_FALSE(held_out_bound_of(held_out_cloud(flat_sheet), 1));
}

TEST(HeldOut, IsTheSameForAnyNumberOfThreads) {
  const Positions points = held_out_cloud(three_sheets);
  const auto one = held_out_bound_of(points, 1.5 * kNoiseHeldOut, 1);
  ASSERT_TRUE(one);
  EXPECT_EQ(one, held_out_bound_of(points, 1.5 * kNoiseHeldOut, 3));
}

}  // namespace
