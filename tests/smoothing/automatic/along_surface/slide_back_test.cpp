#include "smoothing/automatic/along_surface/slide_back.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "rfs_mesh/search/neighbors.h"

using namespace rfsmooth;

namespace {

rfs_mesh::NeighborTable nearest_of(const Positions& points) {
  return rfs_mesh::SpatialIndex(points, {}).nearest(32, {});
}

TEST(SlideBack, LeavesAMoveAlongTheNormalAndStaysOnTheSurface) {
  const Positions clean = clouds::sample(*clouds::make_sphere(), 3000, 1);
  const double spacing = clouds::mean_spacing(clean);
  Positions before = clean;
  clouds::add_noise(before, 0.4 * spacing, 2);
  Positions points = clean;
  smoothing::slide_back(points, before, nearest_of(points), {});
  ASSERT_EQ(points.size(), clean.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points[i].norm(), 1, 0.02 * spacing);
    EXPECT_LT(points[i].cross(before[i].normalized()).norm(), 0.05 * spacing);
  }
}

TEST(SlideBack, FindsTheFootHoweverFarThePointsWentAlong) {
  // They crowd together and pass each other, as far as four spacings.
  const Positions before = clouds::sample(*clouds::make_sphere(), 3000, 1);
  const double spacing = clouds::mean_spacing(before);
  Positions points = before;
  for (Eigen::Vector3d& p : points)
    p = (p + 0.3 * std::sin(8 * p.z()) * Eigen::Vector3d::UnitZ()).normalized();
  smoothing::slide_back(points, before, nearest_of(points), {});
  ASSERT_EQ(points.size(), before.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT((points[i] - before[i]).norm(), 0.5 * spacing) << i;
}

TEST(SlideBack, WhatWasNotMovedStays) {
  const Positions clean = clouds::sample(*clouds::make_sphere(), 3000, 1);
  Positions points = clean;
  smoothing::slide_back(points, clean, nearest_of(points), {});
  EXPECT_EQ(points, clean);
  for (const std::size_t few : {0, 1, 5, 24}) {
    Positions some(clean.begin(), clean.begin() + std::ptrdiff_t(few));
    const Positions kept = some;
    smoothing::slide_back(some, Positions(few, Eigen::Vector3d(1, 2, 3)), nearest_of(some), {});
    EXPECT_EQ(some, kept);
  }
  Positions same(100, Eigen::Vector3d(1, 2, 3));  // no surface to move along
  smoothing::slide_back(same, Positions(100, Eigen::Vector3d(2, 2, 3)), nearest_of(same), {});
  for (const Eigen::Vector3d& p : same) EXPECT_EQ(p, Eigen::Vector3d(1, 2, 3));
}

TEST(SlideBack, IsTheSameForAnyNumberOfThreads) {
  const Positions clean = clouds::sample(*clouds::make_sphere(), 3000, 1);
  Positions before = clean, one_thread = clean, four_threads = clean;
  clouds::add_noise(before, 0.01, 2);
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  smoothing::slide_back(one_thread, before, nearest_of(clean), one);
  smoothing::slide_back(four_threads, before, nearest_of(clean), four);
  EXPECT_EQ(one_thread, four_threads);
}

TEST(SlideBack, TooFewNeighboursAreRefused) {
  Positions points = clouds::sample(*clouds::make_sphere(), 300, 1);
  const Positions before = points;
  EXPECT_THROW(smoothing::slide_back(points, before, rfs_mesh::SpatialIndex(points, {}).nearest(8, {}), {}),
               std::invalid_argument);
}

}  // namespace
