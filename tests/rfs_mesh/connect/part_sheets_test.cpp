#include "rfs_mesh/connect/part_sheets.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "tests/support/shapes.h"
#include "tests/support/threads.h"

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;
using Eigen::Vector3d;

namespace {

constexpr double kUnit = 0.02;  // spacing of 2,500 points on the unit square
constexpr double kSigma = 0.5 * kUnit, kGap = 6 * kSigma;
constexpr int kAround = 24;

/// Points with a shadow and a normal each, as the quadrics would give them.
struct Scene {
  Positions points;
  std::vector<LocalSurface> surfaces;

  void add(const Vector3d& point, const Vector3d& shadow) {
    points.push_back(point);
    surfaces.push_back({Vector3d::UnitZ(), shadow});
  }
  /// Points of the unit square at that height, moved by noise, with their shadows where they came from.
  void add_sheet(double height, unsigned seed, double from_x = 0, double to_x = 1) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal(0, kSigma);
    for (Vector3d p : test::poisson_points(test::plane(), 2500, seed)) {
      if (p[0] < from_x || p[0] > to_x) continue;
      p[2] = height;
      add(p + std::clamp(normal(engine), -2 * kSigma, 2 * kSigma) * Vector3d::UnitZ(), p);
    }
  }
  std::vector<char> part(int threads = 1) {
    Positions shadows;
    for (const LocalSurface& s : surfaces) shadows.push_back(s.shadow);
    const SpatialIndex index(shadows, {});
    Context context;
    context.threads = threads;
    std::vector<char> between;
    in_arena(context, [&] {
      between =
          part_sheets(points, index, index.nearest(kAround, {}), kSigma, SheetsOptions{}, surfaces, context);
    });
    return between;
  }
};

Scene plate() {
  Scene scene;
  scene.add_sheet(0, 1);
  scene.add_sheet(kGap, 2);
  return scene;
}

/// Places over the inner part of the square, two spacings and more apart.
Positions inner_places(double height) {
  Positions places;
  for (double x = 0.2; x < 0.81; x += 0.15)
    for (double y = 0.2; y < 0.81; y += 0.15) places.emplace_back(x, y, height);
  return places;
}

TEST(PartSheets, NothingChangesOnASingleSheet) {
  Scene scene;
  scene.add_sheet(0, 1);
  for (const Vector3d& p : inner_places(4 * kSigma)) scene.add(p, {p[0], p[1], 0});  // far off, yet only one
  const auto before = scene.surfaces;
  EXPECT_TRUE(scene.part().empty());
  for (std::size_t i = 0; i < before.size(); ++i)
    ASSERT_TRUE(before[i].shadow == scene.surfaces[i].shadow && before[i].normal == scene.surfaces[i].normal);
}

TEST(PartSheets, NothingChangesForPointsNearTheirSheets) {
  Scene scene = plate();
  const auto before = scene.surfaces;
  EXPECT_TRUE(scene.part().empty());
  for (std::size_t i = 0; i < before.size(); ++i) ASSERT_TRUE(before[i].shadow == scene.surfaces[i].shadow);
}

TEST(PartSheets, PointsInTheMiddleAreBetween) {
  // Wherever their shadows are: on either sheet or left in the middle.
  for (const double shadow : {0.0, 0.5, 1.0})
    for (const double place : {0.44, 0.5, 0.56}) {
      Scene scene = plate();
      const std::size_t sheets = scene.points.size();
      for (const Vector3d& p : inner_places(place * kGap)) scene.add(p, {p[0], p[1], shadow * kGap});
      const auto between = scene.part();
      ASSERT_EQ(between.size(), scene.points.size());
      EXPECT_EQ(std::count(between.begin(), between.begin() + std::ptrdiff_t(sheets), 1), 0);
      EXPECT_EQ(std::count(between.begin() + std::ptrdiff_t(sheets), between.end(), 1),
                std::ptrdiff_t(scene.points.size() - sheets))
          << "shadows at " << shadow << ", points at " << place;
    }
}

TEST(PartSheets, ShadowsLeftInTheMiddleGoToTheNearerSheet) {
  for (const bool upper : {false, true}) {
    Scene scene = plate();
    const std::size_t sheets = scene.points.size();
    for (const Vector3d& p : inner_places((upper ? 0.7 : 0.3) * kGap)) {
      scene.add(p, {p[0], p[1], 0.5 * kGap});
      scene.surfaces.back().normal = Vector3d::UnitX();
    }
    EXPECT_TRUE(scene.part().empty());
    for (std::size_t i = sheets; i < scene.points.size(); ++i) {
      EXPECT_LT(
          (scene.surfaces[i].shadow - Vector3d(scene.points[i][0], scene.points[i][1], upper ? kGap : 0))
              .norm(),
          0.1 * kSigma);
      EXPECT_GT(std::abs(scene.surfaces[i].normal[2]), 0.999);
    }
  }
}

TEST(PartSheets, AStepIsNotTwoSheets) {
  // Two half planes side by side at different heights: points over the step look at both, from beside.
  Scene scene;
  scene.add_sheet(0, 1, 0, 0.5);
  scene.add_sheet(kGap, 2, 0.5, 1);
  for (double y = 0.2; y < 0.8; y += 0.1) scene.add({0.5, y, 0.5 * kGap}, {0.5, y, 0.5 * kGap});
  EXPECT_TRUE(scene.part().empty());
}

TEST(PartSheets, SameForAnyNumberOfThreads) {
  Scene scene = plate();
  for (const double place : {0.35, 0.5})
    for (Vector3d p : inner_places(place * kGap)) {
      p[0] += 0.1 * place;
      scene.add(p, {p[0], p[1], 0.6 * kGap});
    }
  Scene one = scene;
  const auto between = one.part(1);
  for (const int threads : test::several_threads()) {
    Scene many = scene;
    EXPECT_EQ(many.part(threads), between);
    for (std::size_t i = 0; i < one.points.size(); ++i)
      ASSERT_TRUE(one.surfaces[i].shadow == many.surfaces[i].shadow &&
                  one.surfaces[i].normal == many.surfaces[i].normal);
  }
}

TEST(PartSheets, FewPointsAreLeftAlone) {
  for (const int n : {0, 1, 2, 3, 9}) {
    Scene scene;
    for (int i = 0; i < n; ++i) scene.add({0.01 * i, 0, 0}, {0.01 * i, 0, i % 2 == 0 ? kGap : 0});
    EXPECT_TRUE(scene.part().empty()) << n;
  }
}

}  // namespace
