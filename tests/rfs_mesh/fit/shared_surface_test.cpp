#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "rfs_mesh/fit/local_surface.h"
#include "tests/support/shapes.h"
#include "tests/support/threads.h"

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

constexpr int kNear = 24;

Positions with_noise(Positions points, double sigma) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0, sigma);
  for (auto& p : points) {
    const double x = normal(engine), y = normal(engine), z = normal(engine);
    p += Eigen::Vector3d(x, y, z);
  }
  return points;
}

std::vector<LocalSurface> shared(const Positions& points, std::size_t m, double sigma) {
  const SpatialIndex index(points, {});
  const std::vector<double> noise(points.size(), sigma);
  return shared_local_surfaces(index, index.nearest(kNear, {}), {sigma, m}, noise, {}, kNear, {});
}

/// The bytes of a surface.
std::array<double, 7> numbers(const LocalSurface& s) {
  return {s.normal[0], s.normal[1], s.normal[2], s.shadow[0], s.shadow[1], s.shadow[2], s.residual};
}

TEST(SharedSurface, AQuadricIsReproduced) {
  // z = x^2 - x y on a plane's sample: whatever group a point is in, the quadric through it is this one.
  Positions points = test::random_points(test::plane(), 3000, 1);
  for (auto& p : points) p[2] = p[0] * p[0] - p[0] * p[1];
  const auto surfaces = shared(points, 48, 1e-4);
  ASSERT_EQ(surfaces.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    const Eigen::Vector3d truth = Eigen::Vector3d(-2 * p[0] + p[1], p[0], 1).normalized();
    EXPECT_LT((surfaces[i].shadow - p).norm(), 2e-3) << i;
    EXPECT_GT(std::abs(surfaces[i].normal.dot(truth)), 0.99) << i;
  }
}

TEST(SharedSurface, APlaneIsReproducedExactly) {
  const Positions points = test::random_points(test::plane(), 1000, 2);
  const std::vector<LocalSurface> surfaces = shared(points, 48, 1e-3);
  ASSERT_EQ(surfaces.size(), points.size());
  for (const LocalSurface& s : surfaces) {
    EXPECT_NEAR(std::abs(s.normal[2]), 1, 1e-12);
    EXPECT_NEAR(s.shadow[2], 0, 1e-12);
    EXPECT_NEAR(s.residual, 0, 1e-12);
  }
}

class SharedOnNoisySphere : public testing::TestWithParam<std::pair<double, int>> {};

TEST_P(SharedOnNoisySphere, IsAsGoodAsAQuadricForEachPoint) {
  const auto [noise, m] = GetParam();
  const test::Shape sphere = test::unit_sphere();
  const Positions clean = test::poisson_points(sphere, 4000, 3);
  const double sigma = noise * std::sqrt(sphere.area / double(clean.size()));
  const Positions points = with_noise(clean, sigma);
  const SpatialIndex index(points, {});
  const auto own = local_surfaces(points, index.nearest(m, {}), {});
  const auto together = shared(points, std::size_t(m), sigma);
  const auto errors = [&](const std::vector<LocalSurface>& surfaces) {
    double off = 0, tilt = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      off += std::pow(surfaces[i].shadow.norm() - 1, 2);
      tilt += 1 - std::abs(surfaces[i].normal.dot(points[i].normalized()));
    }
    return std::pair(off, tilt);
  };
  EXPECT_LE(errors(together).first, errors(own).first);
  EXPECT_LE(errors(together).second, 1.2 * errors(own).second);
}

INSTANTIATE_TEST_SUITE_P(Noise, SharedOnNoisySphere,
                         testing::Values(std::pair(0.5, 24), std::pair(1.0, 96), std::pair(2.0, 192)));

TEST(SharedSurface, SheetsStayApart) {
  // Two sheets three spacings apart, noise of 0.3: nearly every shadow is on its own side.
  const double spacing = 0.02;
  Positions clean;
  for (const double z : {0.0, 3 * spacing})
    for (Eigen::Vector3d p : test::poisson_points(test::plane(), 2500, z == 0 ? 1 : 2)) {
      p[2] = z;
      clean.push_back(p);
    }
  const auto surfaces = shared(with_noise(clean, 0.3 * spacing), 24, 0.3 * spacing);
  std::size_t strayed = 0;
  for (std::size_t i = 0; i < clean.size(); ++i)
    strayed += std::abs(surfaces[i].shadow[2] - clean[i][2]) > 1.5 * spacing;
  EXPECT_LT(double(strayed), 0.001 * double(clean.size()));
}

TEST(SharedSurface, EveryPlaceIsFittedForItsOwnNoise) {
  // A tenfold noise where x > 0.5: well inside, each half is what it were if all of the cloud had its noise.
  constexpr double kCalm = 0.003, kLoud = 0.03, kBorder = 0.25;
  const Positions clean = test::random_points(test::plane(), 4000, 6);
  const Positions calm = with_noise(clean, kCalm), loud = with_noise(clean, kLoud);
  Positions points = clean;
  std::vector<double> noise(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool here = clean[i].x() > 0.5;
    points[i] = here ? loud[i] : calm[i];
    noise[i] = here ? kLoud : kCalm;
  }
  const SpatialIndex index(points, {});
  const auto surfaces =
      shared_local_surfaces(index, index.nearest(kNear, {}), {kLoud, 96}, noise, {}, kNear, {});
  const auto all_calm = shared(points, 96, kCalm), all_loud = shared(points, 96, kLoud);
  std::size_t inside = 0, apart = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(clean[i].x() - 0.5) < kBorder) continue;
    ++inside;
    const bool here = clean[i].x() > 0.5;
    const auto &alike = here ? all_loud[i] : all_calm[i], &other = here ? all_calm[i] : all_loud[i];
    EXPECT_EQ(numbers(surfaces[i]), numbers(alike)) << i;
    apart += std::size_t(numbers(surfaces[i]) != numbers(other));
  }
  EXPECT_GT(inside, 1000U);
  EXPECT_GT(apart, inside / 4);
}

/// How many of the points' surfaces differ from `other`, where wanted.
template <class Other, class Wanted>
std::size_t count_others(const std::vector<LocalSurface>& surfaces, const Other& other,
                         const Wanted& wanted) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    if (wanted(i)) count += std::size_t((surfaces[i].shadow - other(i)).norm() > 1e-9);
  return count;
}

TEST(SharedSurface, APartOfACloudHasThoseOfTheWholeAwayFromTheCut) {
  const Positions points = with_noise(test::random_points(test::torus(), 20000, 1), 0.03);
  Positions part;
  std::vector<std::size_t> number;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].x() >= 0) {
      part.push_back(points[i]);
      number.push_back(i);
    }
  for (const std::size_t m : {48, 192}) {
    const auto whole = shared(points, m, 0.03), alone = shared(part, m, 0.03);
    EXPECT_EQ(count_others(
                  alone, [&](std::size_t i) { return whole[number[i]].shadow; },
                  [&](std::size_t i) { return part[i].x() > 0.8; }),
              0u)
        << m;
  }
}

TEST(SharedSurface, TurnsWithTheCloud) {
  const Positions points = with_noise(test::random_points(test::torus(), 5000, 1), 0.03);
  const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d(1, 2, -1).normalized());
  Positions turned = points;
  for (auto& p : turned) p = turn * p;
  for (const std::size_t m : {48, 192}) {
    const auto before = shared(points, m, 0.03), after = shared(turned, m, 0.03);
    const std::size_t others = count_others(
        after, [&](std::size_t i) { return turn * before[i].shadow; }, [](std::size_t) { return true; });
    EXPECT_LT(others, points.size() / 10) << "the m nearest are told apart in single precision, m = " << m;
  }
}

TEST(SharedSurface, SameBytesForAnyNumberOfThreads) {
  const Positions points = with_noise(test::random_points(test::torus(), 4000, 5), 0.03);
  const SpatialIndex index(points, {});
  const NeighborTable near = index.nearest(kNear, {});
  const std::vector<double> noise(points.size(), 0.03);
  const auto run = [&](int threads) {
    Context context;
    context.threads = threads;
    std::vector<LocalSurface> surfaces;
    in_arena(context, [&] {
      surfaces = shared_local_surfaces(index, near, {0.03, 96}, noise, {}, kNear, context);
    });
    return surfaces;
  };
  const auto one = run(1);
  for (const int threads : test::several_threads()) {
    const auto many = run(threads);
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_TRUE(one[i].shadow == many[i].shadow && one[i].normal == many[i].normal) << i;
  }
}

}  // namespace
