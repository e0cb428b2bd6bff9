/// What `denoise` makes of several scans that do not quite meet.
#include <random>

#include <gtest/gtest.h>

#include "tests/pipeline/noise/noisy_sphere.h"

using namespace rfsmooth;
using namespace rfsmooth::noisy;

namespace {

TEST(NoiseLaws, TwoLayersATenthOfASpacingApartBecomeOneSurface) {
  std::mt19937_64 engine(8);
  std::bernoulli_distribution upper(0.5);
  std::normal_distribution<double> normal(0, 0.015 * spacing());
  const Positions noisy =
      off_sphere([&](std::size_t) { return (upper(engine) ? 0.05 : -0.05) * spacing() + normal(engine); });
  EXPECT_LT(rms_off(denoised(noisy), everywhere), 0.2 * rms_off(noisy, everywhere));
}

/// Scans of the unit sphere, each moved by one of `moves`; these and the noise in mean distances of points at
/// random to their nearest.
Positions scans_that_do_not_meet(const std::vector<Eigen::Vector3d>& moves, double noise) {
  constexpr std::size_t kPoints = 8000;
  const double to_nearest = 0.5 * std::sqrt(4 * M_PI / double(kPoints));
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  Positions scans;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d at = Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
    scans.push_back((1 + noise * to_nearest * normal(engine)) * at + to_nearest * moves[i % moves.size()]);
  }
  return scans;
}

// Farther apart here than there, and nowhere the sides of a wall.
TEST(NoiseLaws, TwoScansThatDoNotQuiteMeetBecomeOneSurface) {
  const Positions scans = scans_that_do_not_meet({{0.24, 0.32, 0.3}, {-0.24, -0.32, -0.3}}, 0.1);
  EXPECT_LT(rms_off(denoised(scans), everywhere), 0.2 * rms_off(scans, everywhere));
}

// Some of them are as far apart as walls' sides may be, but louder places are nearly everywhere.
TEST(NoiseLaws, FourScansFartherApartComeTogether) {
  const Positions scans =
      scans_that_do_not_meet({{0.7, 0.7, 0.7}, {0.7, -0.7, -0.7}, {-0.7, 0.7, -0.7}, {-0.7, -0.7, 0.7}}, 0.3);
  EXPECT_LT(rms_off(denoised(scans), everywhere), 0.2 * rms_off(scans, everywhere));
}

// Half of the places look like two sheets here, but none has more points than the others.
TEST(NoiseLaws, ThreeScansFartherApartComeTogether) {
  const Positions scans = scans_that_do_not_meet({{1.6, 0, 0}, {-0.8, 1.4, 0}, {-0.8, -1.4, 0}}, 0.4);
  EXPECT_LT(rms_off(denoised(scans), everywhere), 0.2 * rms_off(scans, everywhere));
}

/// Points of which none is nearer to another than `least`: the first in their order stay.
Positions thinned(const Positions& points, double least) {
  const rfs_mesh::SpatialIndex index(points, {});
  std::vector<char> gone(points.size(), 0);
  std::vector<rfs_mesh::Neighbor> near;
  Positions left;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (gone[i] != 0) continue;
    left.push_back(points[i]);
    index.within(points[i], least, near);
    for (const auto& q : near) gone[q.index] = 1;
  }
  return left;
}

// As CloudCompare thins scans once they are merged. Layers nearer to each other than that distance keep each
// other's points off; beyond, each is as dense as a single scan.
TEST(NoiseLaws, ScansThatDoNotMeetAndWereThinnedToADistanceBecomeOneSurface) {
  constexpr double kLeast = 0.045;
  for (const double apart : {0.8, 1.3}) {
    std::mt19937_64 engine(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::normal_distribution<double> normal(0, 0.1 * kLeast);
    const Eigen::Vector3d half = 0.5 * apart * kLeast * Eigen::Vector3d(0.6, 0.48, 0.64);
    Positions scans;
    for (int i = 0; i < 90000; ++i) {
      Eigen::Vector3d p(uniform(engine), uniform(engine), uniform(engine));
      p[i % 3] = i % 2 == 0 ? 1 : -1;
      p += Eigen::Vector3d(normal(engine), normal(engine), normal(engine));
      scans.push_back(uniform(engine) < 0 ? Eigen::Vector3d(p + half) : Eigen::Vector3d(p - half));
    }
    const auto off_the_box = [](const Eigen::Vector3d& p) {
      const Eigen::Array3d beyond = p.array().abs() - 1;
      return beyond.maxCoeff() > 0 ? beyond.max(0).matrix().norm() : beyond.maxCoeff();
    };
    const Positions noisy = thinned(scans, kLeast);
    ASSERT_GT(noisy.size(), 4500U);
    EXPECT_LT(rms(denoised(noisy), off_the_box), 0.2 * rms(noisy, off_the_box)) << apart;
  }
}

}  // namespace
