/// What `denoise` makes of depths and ranges in steps, and of the rings of a laser.
#include <cmath>
#include <random>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include <rfsmooth/denoise.h>

#include "rfs_mesh/fit/local_surface.h"
#include "tests/pipeline/noise/noisy_sphere.h"
#include "tests/support/shapes.h"

using namespace rfsmooth;
using namespace rfsmooth::noisy;

namespace {

/// What a laser at the origin sees of a room, in steps of range, with noise of so many steps before.
Positions laser_room(double step = 0.01, double noise = 0.6) {
  std::mt19937_64 engine(6);
  std::normal_distribution<double> normal;
  Positions points;
  for (int i = 0; i < 15000; ++i) {
    const Eigen::Vector3d ray = Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
    const double range = Eigen::Array3d(3, 2, 1.3).cwiseQuotient(ray.array().abs()).minCoeff();
    points.push_back(step * std::round(range / step + noise * normal(engine)) * ray);
  }
  return points;
}

double rms_off_walls(const Positions& points) {
  double sum = 0;
  for (const Eigen::Vector3d& p : points)
    sum += std::pow((p.array().abs() - Eigen::Array3d(3, 2, 1.3)).abs().minCoeff(), 2);
  return std::sqrt(sum / double(points.size()));
}

TEST(NoiseLaws, RangesInStepsAreSeenWhereverTheLaserStood) {
  const Positions room = laser_room();
  Positions smooth = room, moved = room;
  const DenoiseReport report = denoise(smooth);
  EXPECT_NEAR(report.measured.step, 0.01, 1e-5);
  EXPECT_NEAR(report.noise / rms_off_walls(room), 1, 0.25);
  EXPECT_LT(rms_off_walls(smooth), 0.4 * rms_off_walls(room));
  // Strays are on no step, and a file of tenths of a millimetre holds the steps only roughly.
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Positions stored = room, with_strays = room;
  for (Eigen::Vector3d& p : stored) p = 1e-4 * (1e4 * p).array().round();
  for (std::size_t i = 0; i < room.size() / 50; ++i)
    with_strays.emplace_back(3 * uniform(engine), 2 * uniform(engine), 1.3 * uniform(engine));
  for (Positions cloud : {with_strays, stored}) {
    constexpr double kOnlyMeasured = 0;
    EXPECT_NEAR(denoise(cloud, kOnlyMeasured).measured.step, 0.01, 2e-4);
  }
  // Elsewhere in the file's coordinates the shells themselves tell where the laser stood.
  const Eigen::Vector3d shift(0.4, -0.3, 0.2);
  for (Eigen::Vector3d& p : moved) p += shift;
  EXPECT_NEAR(denoise(moved).measured.step, 0.01, 1e-4);
  for (Eigen::Vector3d& p : moved) p -= shift;
  EXPECT_LT(rms_off_walls(moved), 0.4 * rms_off_walls(room));
}

TEST(NoiseLaws, RangesInStepsThatAreWiderThanTheNoiseAreSmoothed) {
  const double spacing = std::sqrt(8 * (3 * 2 + 3 * 1.3 + 2 * 1.3) / 15000);
  for (const double step : {2 * spacing, 3 * spacing})
    for (const double noise : {0.15, 0.35}) {
      const Positions room = laser_room(step, noise);
      EXPECT_LT(rms_off_walls(denoised(room)), 0.5 * rms_off_walls(room)) << step << ' ' << noise;
    }
}

TEST(NoiseLaws, WhereASurfaceFacesTheCameraItsStepsAreSmoothedToo) {
  constexpr std::size_t kPoints = 8000;
  constexpr double kRim = 0.9;
  const double spacing = std::sqrt(M_PI * kRim * kRim / double(kPoints));
  for (const double step : {spacing, 2 * spacing})
    for (const double noise : {0.0, 0.1, 0.2}) {  // steps
      std::mt19937_64 engine(8);
      std::uniform_real_distribution<double> uniform(0, 1);
      std::normal_distribution<double> normal(0, noise);
      Positions cap;  // of a sphere, seen along z
      for (std::size_t i = 0; i < kPoints; ++i) {
        const double off = kRim * std::sqrt(uniform(engine)), turn = 2 * M_PI * uniform(engine);
        const double depth = std::sqrt(1 - off * off),
                     told = step * std::round(depth / step + normal(engine));
        cap.emplace_back(off * std::cos(turn), off * std::sin(turn), told);
      }
      Positions smooth = cap;
      const DenoiseReport report = denoise(smooth);
      EXPECT_NEAR(report.measured.step, step, 1e-9);
      EXPECT_GT(report.measured.shared, 1);
      EXPECT_LT(rms_off(smooth, everywhere), 0.2 * rms_off(cap, everywhere)) << step << ' ' << noise;
    }
}

TEST(NoiseLaws, AWallBeforeADepthCameraIsNotTorn) {
  // Pixels of a camera whose disparities are whole: terraces of 25 mm, a dozen pixels wide, at 3 m.
  constexpr int kWide = 100, kHigh = 75, kCell = 3;
  constexpr double kFocal = 525, kDisparity = 360, kSlope = 0.3;
  Positions seen;
  for (int v = -kHigh; v < kHigh; ++v)
    for (int u = -kWide; u < kWide; ++u) {
      const double depth = 3 / (1 - kSlope * u / kFocal), told = kDisparity / std::round(kDisparity / depth);
      seen.emplace_back(told * u / kFocal, told * v / kFocal, told);
    }
  const Positions smooth = denoised(seen);
  std::set<std::pair<int, int>> filled;
  const auto cell = [](double at) { return int(std::floor((at + 0.5) / kCell)); };
  double before = 0, after = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Eigen::Vector3d& p = smooth[i];
    filled.emplace(cell(kFocal * p.x() / p.z()), cell(kFocal * p.y() / p.z()));
    before += std::pow(seen[i].z() - 3 - kSlope * seen[i].x(), 2);
    after += std::pow(p.z() - 3 - kSlope * p.x(), 2);
  }
  EXPECT_LT(std::sqrt(after / before), 0.25);
  int cells = 0, empty = 0;
  for (int v = cell(-kHigh) + 2; v < cell(kHigh) - 2; ++v)
    for (int u = cell(-kWide) + 2; u < cell(kWide) - 2; ++u, ++cells) empty += int(filled.count({u, v}) == 0);
  ASSERT_GT(cells, 2000);
  EXPECT_LT(double(empty) / double(cells), 0.005);
}

TEST(NoiseLaws, ASlopeInDepthsOfStepsIsSmoothedBesideAnExactFloor) {
  const double spacing = std::sqrt(2.0 / 10000), step = 4 * spacing;
  for (const double slope : {0.5, 1.0}) {
    std::mt19937_64 engine(9);
    std::uniform_real_distribution<double> uniform(0, 1);
    Positions stepped;
    for (int i = 0; i < 10000; ++i) {
      const double x = 2 * uniform(engine) - 1;
      stepped.emplace_back(x, uniform(engine), step * std::round(std::max(0.0, slope * x) / step));
    }
    const Positions smooth = denoised(stepped);
    double before = 0, after = 0, floor = 0;
    for (std::size_t i = 0; i < stepped.size(); ++i) {
      const double x = stepped[i].x();
      if (x < -0.1) floor = std::max(floor, std::abs(smooth[i].z()));
      if (x < 0.1) continue;
      before += std::pow(stepped[i].z() - slope * x, 2);
      after += std::pow(smooth[i].z() - slope * smooth[i].x(), 2);
    }
    EXPECT_LT(after, 0.6 * before) << slope;
    EXPECT_LT(floor, 0.2 * spacing) << slope;
  }
}

TEST(NoiseLaws, AThinPlateInDepthsOfStepsStaysAPlate) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto height = [](const Eigen::Vector3d& p) { return 0.03 + 0.005 * std::sin(3 * p.x()); };
  const auto rms = [&](const Positions& points) {
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double side = i % 2 == 0 ? 0 : -0.06;
      sum += std::pow(points[i].z() - side - height(points[i]), 2);
    }
    return std::sqrt(sum / double(points.size()));
  };
  Positions plate;
  for (int i = 0; i < 20000; ++i) {
    Eigen::Vector3d p(uniform(engine), 0.8 * uniform(engine), 0);
    constexpr double kStep = 0.0074;
    p.z() = kStep * std::round((height(p) - (i % 2 == 0 ? 0 : 0.06)) / kStep);
    plate.push_back(p);
  }
  EXPECT_LE(rms(denoised(plate)), 1.01 * rms(plate));
}

/// What a plate of so many points shows: two sheets, `thick` and noise in spacings.
struct Plate {
  double thick, sigma;
};

TEST(NoiseLaws, OfAThinPlateIsThatOfItsSheetsNotTheirDistance) {
  constexpr std::size_t kPoints = 4000;
  const double spacing = 0.5 * std::sqrt(2.0 / double(kPoints));  // of random points on two unit squares
  for (const Plate& plate :
       {Plate{1.5, 0.02}, Plate{1.5, 0.2}, Plate{2, 0.35}, Plate{3, 0.2}, Plate{3, 0.35}}) {
    SCOPED_TRACE(testing::Message() << plate.thick << " spacings thick, noise of " << plate.sigma);
    std::mt19937_64 engine(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> noise(0, plate.sigma * spacing);
    const auto side = [&](std::size_t i) { return i % 2 == 0 ? 0 : plate.thick * spacing; };
    Positions points;
    for (std::size_t i = 0; i < kPoints; ++i)
      points.emplace_back(uniform(engine), uniform(engine), side(i) + noise(engine));
    const auto off_its_side = [&](const Positions& of) {
      double sum = 0;
      for (std::size_t i = 0; i < kPoints; ++i) sum += std::pow(of[i].z() - side(i), 2);
      return std::sqrt(sum / double(kPoints)) / spacing;
    };
    Positions smooth = points;
    const double figure = denoise(smooth).noise;
    if (plate.sigma >= 0.2) {
      const double read = figure / (plate.sigma * spacing);
      EXPECT_GT(read, 1 / 1.3);
      EXPECT_LT(read, 1.3);
    }
    EXPECT_LE(off_its_side(smooth), off_its_side(points) + 0.01);
  }
}

TEST(NoiseLaws, ATorusInDepthsOfStepsIsNotTornIntoSheets) {
  for (const unsigned seed : {1U, 2U}) {
    Positions stepped = test::random_points(test::torus(), 10000, seed);
    const rfs_mesh::SpatialIndex index(stepped, {});
    const double step = rfs_mesh::mean_spacing(rfs_mesh::nearest_distances(index, {}), {});
    for (Eigen::Vector3d& p : stepped) p.z() = step * std::round(p.z() / step);
    const auto rms = [](const Positions& points) {
      double sum = 0;
      for (const Eigen::Vector3d& p : points)
        sum += std::pow(std::hypot(std::hypot(p.x(), p.y()) - 1, p.z()) - 0.4, 2);
      return std::sqrt(sum / double(points.size()));
    };
    EXPECT_LT(rms(denoised(stepped)), 0.5 * rms(stepped)) << seed;
  }
}

constexpr double kRing = M_PI / 36, kAlongRing = kRing / 20;  // angles between rings, and between points

/// Rings on the unit sphere, 20 times farther apart than their points, seen from outside: `noise` along the
/// ray.
Positions rings_on_sphere(double noise, unsigned seed) {
  const Eigen::Vector3d scanner(2.5, 0.4, 0.8);
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0, noise);
  Positions points;
  for (double polar = kRing / 2; polar < M_PI; polar += kRing) {
    const auto count = int(2 * M_PI * std::sin(polar) / kAlongRing);
    for (int i = 0; i < count; ++i) {
      const double turn = 2 * M_PI * i / count;
      const Eigen::Vector3d p(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                              std::cos(polar));
      points.emplace_back(p + normal(engine) * (p - scanner).normalized());
    }
  }
  return points;
}

TEST(NoiseLaws, RingsOfALaserAreSmoothedAlongThemAndAcross) {
  for (const unsigned seed : {1U, 2U}) {
    const Positions scan = rings_on_sphere(0.4 * kAlongRing, seed);
    Positions smooth = scan;
    EXPECT_TRUE(denoise(smooth).measured.on_lines) << seed;
    EXPECT_LT(rms_off(smooth, everywhere), 0.35 * rms_off(scan, everywhere)) << seed;
  }
}

TEST(NoiseLaws, RingsWithNoiseOfSeveralStepsAreSmoothed) {
  const Positions scan = rings_on_sphere(3 * kAlongRing, 1);
  EXPECT_LT(rms_off(denoised(scan), everywhere), 0.5 * rms_off(scan, everywhere));
}

TEST(NoiseLaws, RingsWithoutNoiseStay) {
  const Positions scan = rings_on_sphere(0, 1);
  EXPECT_LT(rms_move(scan, denoised(scan)), 0.02 * kAlongRing);
}

// A wall in nine depths: rows and columns of the image leave few values across, too.
TEST(NoiseLaws, AWallBeforeADepthCameraIsCleaned) {
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal(0, 0.004);
  Positions points;
  for (int u = -80; u < 80; ++u)
    for (int v = -60; v < 60; ++v) {
      const double z = 0.01 * std::round((2 + normal(engine)) / 0.01);
      points.emplace_back(u * z / 350, v * z / 350, z);
    }
  EXPECT_LT(rms_height(denoised(points), 2), 0.3 * rms_height(points, 2));
}

}  // namespace
