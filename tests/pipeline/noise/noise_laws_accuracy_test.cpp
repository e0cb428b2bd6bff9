/// What `denoise` makes of noise that is not the same everywhere. Of noise that neighbours share:
/// shared_noise_accuracy_test.cpp; in steps and along lines: steps_and_rings_accuracy_test.cpp; of several
/// scans: merged_scans_accuracy_test.cpp.
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include <rfsmooth/denoise.h>

#include "tests/pipeline/noise/noisy_sphere.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::noisy;

namespace {

TEST(NoiseLaws, TheCalmHalfStaysAndTheLoudHalfIsSmoothed) {
  const auto loud = [](std::size_t i) { return sphere()[i].x() > 0; };
  const auto calm = [](std::size_t i) { return sphere()[i].x() < -0.2; };
  for (const double share : {0.35, 1.0}) {
    std::mt19937_64 engine(3);
    std::normal_distribution<double> normal(0, share * spacing());
    const Positions noisy = off_sphere([&](std::size_t i) { return loud(i) ? normal(engine) : 0; });
    const Positions smooth = denoised(noisy);
    EXPECT_LT(rms_off(smooth, loud), 0.4 * rms_off(noisy, loud)) << share;
    EXPECT_LT(rms_off(smooth, calm), 0.05 * spacing()) << share;
  }
}

// Both halves are noisy: neither may hide the other's noise, nor keep it from being smoothed up to the
// border.
TEST(NoiseLaws, ALoudHalfIsSmoothedBesideACalmOneThatIsNoisyToo) {
  const auto loud = [](std::size_t i) { return sphere()[i].x() > 0; };
  const auto calm = [](std::size_t i) { return sphere()[i].x() < -0.2; };
  for (const double times : {3.0, 5.0}) {
    std::mt19937_64 engine(8);
    std::normal_distribution<double> normal(0, 0.1 * spacing());
    const Positions noisy = off_sphere([&](std::size_t i) { return (loud(i) ? times : 1) * normal(engine); });
    const Positions smooth = denoised(noisy);
    EXPECT_LT(rms_off(smooth, loud), 0.12 * rms_off(noisy, loud)) << times;
    EXPECT_LT(rms_off(smooth, calm), 0.25 * rms_off(noisy, calm)) << times;
  }
}

// Windows that are too narrow for the loud half still hold most of its points, so that they show a little
// more than they were made for: they must open all the way, whatever the draw.
TEST(NoiseLaws, ALoudHalfIsSmoothedAlikeInEveryDraw) {
  constexpr std::size_t kPoints = 20000;
  const double side = std::sqrt(4 * M_PI / double(kPoints));  // of the square that has one point
  for (unsigned seed = 1; seed <= 6; ++seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    const auto draw = [&] {
      const double x = normal(engine), y = normal(engine), z = normal(engine);
      return Eigen::Vector3d(x, y, z);
    };
    Positions noisy;
    std::vector<char> is_loud;
    while (noisy.size() < kPoints) {
      const Eigen::Vector3d at = draw().normalized();
      is_loud.push_back(char(at.x() > 0));
      noisy.push_back(at + (is_loud.back() != 0 ? 1.2 : 0.3) * side * draw());
    }
    const Positions smooth = denoised(noisy);
    for (const char half : {0, 1}) {
      const auto counts = [&](std::size_t i) { return is_loud[i] == half; };
      EXPECT_LT(rms_off(smooth, counts), 0.25 * rms_off(noisy, counts)) << seed << " " << int(half);
    }
  }
}

// In windows for the loud half of a pipe its far wall comes into sight while they open; they must not open on
// to all of the pipe, which would come out as a thread.
TEST(NoiseLaws, ALoudHalfOfPipesIsNoLouderThanItIs) {
  constexpr std::size_t kPerPipe = 6000;
  constexpr int kPipes = 5;
  constexpr double kRadius = 0.12, kLength = 3;
  const double side = std::sqrt(2 * M_PI * kRadius * kLength / double(kPerPipe));  // of one point's square
  const auto axis = [](int pipe) { return Eigen::Vector2d(1.0 * pipe, 0); };
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  Positions noisy;
  for (int pipe = 0; pipe < kPipes; ++pipe) {
    for (std::size_t i = 0; i < kPerPipe; ++i) {
      const double angle = 2 * M_PI * uniform(engine), along = kLength * uniform(engine),
                   sigma = (along < kLength / 2 ? 2 : 0.5) * side;
      const double x = normal(engine), y = normal(engine), z = normal(engine);
      noisy.emplace_back(axis(pipe).x() + kRadius * std::cos(angle) + sigma * x,
                         kRadius * std::sin(angle) + sigma * y, along + sigma * z);
    }
  }
  const auto off = [&](const Positions& points) {
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d from = points[i].head<2>() - axis(int(i / kPerPipe));
      sum += std::pow(from.norm() - kRadius, 2);
    }
    return std::sqrt(sum / double(points.size()));
  };
  Positions smooth = noisy;
  const DenoiseReport report = noisy::denoise(smooth);
  EXPECT_LT(report.noise, 1.5 * 2 * side);
  EXPECT_LT(off(smooth), 0.5 * off(noisy));
}

// A twentieth of a spacing may be detail, but not on a sheet that scatters by no more where more of it is
// seen.
TEST(NoiseLaws, ACalmPlaneIsFlattenedBesideALoudOne) {
  std::mt19937_64 engine(8);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 0.005);  // the points are about 0.005 from their nearest
  Positions noisy;
  for (int i = 0; i < 20000; ++i) {
    const double x = 2 * uniform(engine) - 1, y = uniform(engine);
    noisy.emplace_back(x, y, (x < 0 ? 0.03 : 0.3) * normal(engine));
  }
  const Positions smooth = denoised(noisy);
  const auto calm = [](const Positions& points) {
    Positions part;
    for (const Eigen::Vector3d& p : points)
      if (p.x() < -0.2) part.push_back(p);
    return rms_height(part, 0);
  };
  EXPECT_LT(calm(smooth), 0.3 * calm(noisy));
}

// Three walls of a corner, of dark and of bright paint: none may hide what another one has.
TEST(NoiseLaws, WallsOfACornerAreSmoothedWhateverTheNoiseOfTheOthers) {
  constexpr std::size_t kPerWall = 6000;
  const double spacing = std::sqrt(1.0 / kPerWall);  // side of the square that has one point
  struct Noises {
    std::array<double, 3> of;  // of each wall, spacings
  };
  for (const Noises& noises : {Noises{{0.3, 0.5, 1}}, Noises{{0.1, 0.25, 1.5}}}) {
    std::mt19937_64 engine(4);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal(0, spacing);
    Positions noisy;
    for (Eigen::Index wall = 0; wall < 3; ++wall)
      for (std::size_t i = 0; i < kPerWall; ++i) {
        Eigen::Vector3d p(uniform(engine), uniform(engine), uniform(engine));
        p[wall] = 0;
        for (double& x : p) x += noises.of[std::size_t(wall)] * normal(engine);
        noisy.push_back(p);
      }
    const Positions smooth = denoised(noisy);
    for (std::size_t wall = 0; wall < 3; ++wall) {
      double before = 0, after = 0;
      for (std::size_t i = wall * kPerWall; i < (wall + 1) * kPerWall; ++i) {
        const auto of_wall = Eigen::Index(wall), next = (of_wall + 1) % 3, other = (of_wall + 2) % 3;
        if (noisy[i][next] < 6 * spacing || noisy[i][other] < 6 * spacing) continue;  // the edges
        before += noisy[i][of_wall] * noisy[i][of_wall];
        after += smooth[i][of_wall] * smooth[i][of_wall];
      }
      ASSERT_GT(before, 0);
      EXPECT_LT(std::sqrt(after / before), 0.2)
          << noises.of[wall] << " beside " << noises.of[0] << " to " << noises.of[2];
    }
  }
}

// Dark spots before a laser, which measures them five times as loud: however many points a cloud has, the
// noise of most places is that of the bright ones.
TEST(NoiseLaws, SmallLoudSpotsAreSmoothed) {
  for (const int side : {120, 300}) {
    std::mt19937_64 engine(5);
    std::normal_distribution<double> normal(0, 0.1);
    Positions points;
    std::vector<char> dark;
    for (int x = 0; x < side; ++x)
      for (int y = 0; y < side; ++y) {
        const double from_spot = std::hypot(x % 60 - 30, y % 60 - 30);
        dark.push_back(char(from_spot < 15));
        points.emplace_back(x, y, (dark.back() != 0 ? 5 : 1) * normal(engine));
      }
    const auto off = [&](char which) {
      double sum = 0, count = 0;
      for (std::size_t i = 0; i < points.size(); ++i)
        if (dark[i] == which) sum += points[i].z() * points[i].z(), ++count;
      return std::sqrt(sum / count);
    };
    const double dark_before = off(1), bright_before = off(0);
    ASSERT_TRUE(denoise(points.front().data(), points.size(), {}, {}));
    EXPECT_LT(off(1), 0.5 * dark_before) << side;
    EXPECT_LT(off(0), 0.4 * bright_before) << side;
  }
}

// As hand-held scanners leave it: the neighbourhoods that tell what is a surface must be as wide as the
// noise.
TEST(NoiseLaws, NoiseOfSixSpacingsIsSmoothedToATwelfth) {
  constexpr double kRim = 0.2;
  Positions points;  // a cap: it is its middle that is looked at
  for (const Eigen::Vector3d& p : support::icosphere(6).positions)
    if (p.x() > kRim) points.push_back(p);
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal(0, 3 * spacing());  // half as far apart as those of sphere()
  for (Eigen::Vector3d& p : points) p *= 1 + normal(engine);
  const auto inner = [&](std::size_t i) { return points[i].normalized().x() > kRim + 0.5; };
  EXPECT_LT(rms_off(denoised(points), inner), rms_off(points, inner) / 12);
}

/// What a laser in the origin sees of the surface that meets `ray` at a distance: rays `step` degrees apart
/// within `reach` of the x axis, each with noise along it.
Positions seen_by_laser(const std::function<double(const Eigen::Vector3d&)>& meet, double reach, double step,
                        double noise) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal(0, noise);
  constexpr double kDegree = M_PI / 180;
  Positions points;
  for (double up = -reach; up < reach; up += step)
    for (double side = -reach; side < reach; side += step) {
      const double u = up * kDegree, s = side * kDegree;
      const Eigen::Vector3d ray(std::cos(u) * std::cos(s), std::cos(u) * std::sin(s), std::sin(u));
      if (const double there = meet(ray); std::isfinite(there))
        points.emplace_back((there + normal(engine)) * ray);
    }
  return points;
}

// The near end of a wall has more points, and more of the noise lies across it there: several times as many
// spacings as at the far end.
TEST(NoiseLaws, AWallSeenAtASlantComesOutFlatAtBothEnds) {
  for (const double slant : {45.0, 60.0}) {
    const Eigen::Vector3d normal(std::cos(slant * M_PI / 180), std::sin(slant * M_PI / 180), 0);
    const double away = 3 * normal.x();
    const auto meet = [&](const Eigen::Vector3d& ray) {
      const double there = away / normal.dot(ray);
      return there > 0 && there < 9 ? there : INFINITY;
    };
    const auto off = [&](const Eigen::Vector3d& p) { return p.dot(normal) - away; };
    for (const double noise : {0.015, 0.03, 0.045}) {
      const Positions noisy = seen_by_laser(meet, 22.5, 0.45, noise);
      EXPECT_LT(rms(denoised(noisy), off), 0.25 * rms(noisy, off)) << slant << ' ' << noise;
    }
  }
}

// Noise along the ray is less and less across a ball towards its rim.
TEST(NoiseLaws, ABallSeenFromOneSideComesOutRoundInItsMiddle) {
  const Eigen::Vector3d centre(3.7, 0, 0);
  const auto meet = [&](const Eigen::Vector3d& ray) {
    const double along = ray.dot(centre), inside = along * along - centre.squaredNorm() + 0.25;
    return inside > 0 ? along - std::sqrt(inside) : INFINITY;
  };
  const auto off = [&](const Eigen::Vector3d& p) { return (p - centre).norm() - 0.5; };
  const Positions noisy = seen_by_laser(meet, 8, 0.1, 0.01);
  EXPECT_LT(rms(denoised(noisy), off), 0.2 * rms(noisy, off));
}

TEST(NoiseLaws, PointsThatAreNoisierThanTheirNeighboursComeToTheSurface) {
  for (const double share : {0.05, 0.2}) {
    std::mt19937_64 engine(4);
    std::normal_distribution<double> normal(0, 0.35 * spacing());
    std::bernoulli_distribution wide(share);
    std::vector<char> is_wide(sphere().size());
    const Positions noisy = off_sphere([&](std::size_t i) {
      is_wide[i] = char(wide(engine));
      return (is_wide[i] ? 4 : 1) * normal(engine);
    });
    const Positions smooth = denoised(noisy);
    EXPECT_LT(rms_off(smooth, everywhere), 0.3 * rms_off(noisy, everywhere)) << share;
    const auto tails = [&](std::size_t i) { return is_wide[i] != 0; };
    EXPECT_LT(rms_off(smooth, tails), 0.5 * rms_off(noisy, tails)) << share;
  }
}

// What cannot be told from detail by points as far apart as on average can be where they are dense.
TEST(NoiseLaws, OfDensePartsIsSeenByTheirOwnSpacing) {
  constexpr double kDense = 0.25, kNoise = 0.03;  // sides of two squares' cells, and noise
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal(0, kNoise);
  Positions points;
  const auto add_square = [&](double left, double cell, int count) {
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < count; ++j) points.emplace_back(left + cell * i, cell * j, normal(engine));
  };
  add_square(0, 1, 100);
  const auto sparse = std::ptrdiff_t(points.size());
  add_square(100 + 20 * kDense, kDense, 50);
  const Positions smooth = denoised(points);
  const auto first = [&](const Positions& of) { return Positions(of.begin(), of.begin() + sparse); };
  const auto rest = [&](const Positions& of) { return Positions(of.begin() + sparse, of.end()); };
  EXPECT_LT(rms_height(rest(smooth), 0), 0.3 * rms_height(rest(points), 0));
  EXPECT_LT(rms_height(first(smooth), 0), 0.3 * rms_height(first(points), 0));  // beside it this is told, too
}

// Waves of ten spacings look like small shape, and are believed to be.
TEST(NoiseLaws, StrengthActsWhereNothingIsToldFromShape) {
  Positions waves;
  for (int i = 0; i < 50; ++i)
    for (int j = 0; j < 50; ++j)
      waves.emplace_back(i, j, 0.2 * std::sin(M_PI * i / 5) * std::sin(M_PI * j / 5));
  EXPECT_EQ(rms_move(waves, denoised(waves)), 0);
  EXPECT_GT(rms_move(waves, denoised(waves, 2)), 0);
}

TEST(NoiseLaws, LittleNoiseIsSmoothedWhereItIsToldFromDetail) {
  std::mt19937_64 engine(6);
  std::normal_distribution<double> normal(0, 0.02 * spacing());
  const Positions noisy = off_sphere([&](std::size_t) { return normal(engine); });
  EXPECT_LT(rms_off(denoised(noisy), everywhere), 0.6 * rms_off(noisy, everywhere));
}

TEST(NoiseLaws, LittleStrengthMovesLessThanMuch) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0, 0.08 * spacing());
  const Positions noisy = off_sphere([&](std::size_t) { return normal(engine); });
  const double half = rms_move(noisy, denoised(noisy, 0.5)), full = rms_move(noisy, denoised(noisy));
  EXPECT_GT(half, 0);
  EXPECT_GT(full, half);
}

}  // namespace
