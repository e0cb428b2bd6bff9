#include "rfs_mesh/noise/sites/noise_sites.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "rfs_mesh/noise/noise_levels.h"
#include "tests/support/shapes.h"

namespace rfsmooth::rfs_mesh {
namespace {

constexpr std::size_t kOfPlane = 6000;
constexpr double kSpacingOfPlane = 0.5 / 77.5;  // of so many random points of the unit square

/// The unit square, its points moved up and down by normal noise of `sigma(x)`, in depth steps of `step`.
template <class Sigma>
Positions rough_square(Sigma&& sigma, double step = 0) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  Positions points = test::random_points(test::plane(), kOfPlane, 1);
  for (auto& p : points) {
    p.z() = sigma(p.x()) * normal(engine);
    if (step > 0) p.z() = step * std::round(p.z() / step);
  }
  return points;
}

NoiseSites sites_of(const Positions& points) {
  const SpatialIndex index(points, {});
  const Context context = {};
  Places places = search_places(index, context);
  const NoiseStart start = search_noise(places, nullptr, 0);
  return listen(index, listening_places(points, start.m), start, nullptr, context);
}

double median_where(const NoiseSites& sites, double from, double to) {
  std::vector<double> of;
  for (std::size_t s = 0; s < sites.at.size(); ++s)
    if (sites.at[s].x() >= from && sites.at[s].x() < to) of.push_back(sites.sigma[s]);
  EXPECT_GT(of.size(), 50u);
  std::nth_element(of.begin(), of.begin() + std::ptrdiff_t(of.size() / 2), of.end());
  return of[of.size() / 2];
}

TEST(NoiseSites, ArePointsOfTheCloudWithAValueEach) {
  const Positions points = rough_square([](double) { return 0.5 * kSpacingOfPlane; });
  const NoiseSites sites = sites_of(points);
  const std::size_t n = sites.at.size();
  EXPECT_GE(n, 250u);
  EXPECT_LE(n, 2000u);
  for (const std::size_t size : {sites.sigma.size(), sites.shape.size(), sites.area.size(),
                                 sites.speaks.size(), sites.floor.size(), sites.fits.size()})
    ASSERT_EQ(size, n);
  const auto less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  const std::set<Eigen::Vector3d, decltype(less)> in(points.begin(), points.end(), less);
  for (std::size_t s = 0; s < n; ++s) {
    EXPECT_EQ(in.count(sites.at[s]), 1u);
    EXPECT_GT(sites.sigma[s], 0);
    EXPECT_GE(sites.shape[s], 0);
    EXPECT_LE(sites.shape[s], 0.6);
    EXPECT_GE(sites.area[s], 0);
    EXPECT_LE(sites.area[s], 1);
    EXPECT_GE(sites.floor[s], 0);
  }
}

TEST(NoiseSites, OfASquareFindItsNoise) {
  for (const double spacings : {0.2, 0.5, 1.0}) {
    const double sigma = spacings * kSpacingOfPlane;
    const NoiseSites sites = sites_of(rough_square([&](double) { return sigma; }));
    EXPECT_NEAR(median_where(sites, 0, 1) / sigma, 1, 0.15) << spacings;
    EXPECT_GT(std::count(sites.speaks.begin(), sites.speaks.end(), 1), std::ptrdiff_t(sites.at.size() / 2));
  }
}

TEST(NoiseSites, KnowTheLoudHalfFromTheCalmOne) {
  const double calm = 0.2 * kSpacingOfPlane, loud = 0.6 * kSpacingOfPlane;
  const NoiseSites sites = sites_of(rough_square([&](double x) { return x < 0.5 ? calm : loud; }));
  EXPECT_NEAR(median_where(sites, 0.05, 0.45) / calm, 1, 0.25);
  EXPECT_NEAR(median_where(sites, 0.55, 0.95) / loud, 1, 0.25);
}

// A quadric through any number of leaves leaves a part of the ball that they fill.
TEST(NoiseSites, LeavesAreNoSurfaceAndSpeakOfNoNoise) {
  const double sigma = 0.3 * kSpacingOfPlane;
  Positions points = rough_square([&](double) { return sigma; });
  constexpr double kCrown = 0.12;  // radius
  const Eigen::Vector3d middle(0.5, 0.5, 0.4);
  std::mt19937_64 engine(8);
  std::uniform_real_distribution<double> even(-1, 1);
  while (points.size() < kOfPlane + 700) {
    const Eigen::Vector3d p(even(engine), even(engine), even(engine));
    if (p.norm() < 1) points.emplace_back(middle + kCrown * p);
  }
  const NoiseSites sites = sites_of(points);
  std::size_t in_crown = 0, loud = 0;
  for (std::size_t s = 0; s < sites.at.size(); ++s) {
    if ((sites.at[s] - middle).norm() > kCrown) continue;
    ++in_crown;
    loud += std::size_t(sites.speaks[s] != 0 && sites.sigma[s] > 3 * sigma);
  }
  EXPECT_GT(in_crown, 50u);
  EXPECT_LT(5 * loud, in_crown) << loud;  // a few balls take as many points as any may
}

TEST(NoiseSites, TheUnitDoesNotMatter) {
  Positions points = rough_square([](double) { return 0.5 * kSpacingOfPlane; });
  const NoiseSites here = sites_of(points);
  for (auto& p : points) p *= 0x1p10;
  const NoiseSites there = sites_of(points);
  ASSERT_EQ(here.sigma.size(), there.sigma.size());
  for (std::size_t s = 0; s < here.sigma.size(); ++s)
    EXPECT_NEAR(there.sigma[s], 0x1p10 * here.sigma[s], 1e-6 * there.sigma[s]);
}

/// A hub with twelve ribs, `thick` spacings thick, with normal noise of `sigma` spacings.
Positions ribs(double thick, double sigma) {
  constexpr double kHub = 12, kEnd = 40, kHigh = 10;
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> even;
  std::normal_distribution<double> normal;
  Positions points;
  const auto add = [&](double area, auto&& at) {
    for (int i = 0; i < int(area); ++i) {
      const double a = even(engine), b = even(engine);
      points.push_back(at(a, b) + sigma * Eigen::Vector3d(normal(engine), normal(engine), normal(engine)));
    }
  };
  for (int k = 0; k < 12; ++k) {
    const double turn = 2 * M_PI * k / 12;
    const Eigen::Vector3d out(std::cos(turn), std::sin(turn), 0), side(-out.y(), out.x(), 0);
    const auto rib = [&](double along, double across, double up) {
      return Eigen::Vector3d((kHub + along * (kEnd - kHub)) * out + (across - 0.5) * thick * side +
                             up * kHigh * Eigen::Vector3d::UnitZ());
    };
    for (const double end : {0.0, 1.0}) {
      add((kEnd - kHub) * kHigh, [&](double a, double b) { return rib(a, end, b); });
      add((kEnd - kHub) * thick, [&](double a, double b) { return rib(a, b, end); });
    }
    add(kHigh * thick, [&](double a, double b) { return rib(1, a, b); });
  }
  add(2 * M_PI * kHub * kHigh, [&](double a, double b) {
    return Eigen::Vector3d(kHub * std::cos(2 * M_PI * a), kHub * std::sin(2 * M_PI * a), b * kHigh);
  });
  return points;
}

// Windows that show more take more points, and those show more of the shape, and so on.
TEST(NoiseSites, HearNoMoreThanIsSeenWithoutAWindow) {
  for (const double thick : {4.0, 6.0})
    for (const double sigma : {0.1, 0.4}) {
      const Positions points = ribs(thick, sigma);
      const SpatialIndex index(points, {});
      const Context context = {};
      Places places = search_places(index, context);
      const NoiseStart start = search_noise(places, nullptr, 0);
      const NoiseSites sites = listen(index, listening_places(points, start.m), start, nullptr, {});
      std::size_t known = 0, above = 0;
      for (std::size_t s = 0; s < sites.at.size(); ++s) {
        if (!std::isfinite(sites.most[s])) continue;
        ++known;
        const double most = std::max(start.sigma, kSameNoise * sites.most[s]);
        above += sites.sigma[s] > (1 + 1e-9) * std::max(most, sites.floor[s]) ? 1 : 0;
      }
      EXPECT_GT(known, 100u) << thick << ' ' << sigma;
      EXPECT_EQ(above, 0u) << thick << ' ' << sigma;
    }
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
