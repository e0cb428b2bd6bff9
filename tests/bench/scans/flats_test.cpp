#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "tests/bench/scans/measure_flats.h"

namespace rfsmooth::bench {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kPoints = 40000;

struct NoisyCube {
  Positions clean = clouds::sample(*clouds::make_cube(), kPoints, 1, clouds::Sampling::uniform),
            noisy = clean;
  double spacing = std::sqrt(24.0 / kPoints), sigma = 0.3 * spacing;
  NoisyCube() { clouds::add_noise(noisy, sigma, 2); }
};

TEST(Flats, ACubeHasSixPlanesAndTheirInsideHasTheNoise) {
  const NoisyCube cube;
  const Flats flats = find_flats(cube.noisy, 3);
  EXPECT_EQ(flats.planes, 6u);
  ASSERT_GT(flats.patches.size(), 12u);
  double squares = 0, count = 0;
  for (const Patch& patch : flats.patches) {
    EXPECT_GT(patch.plane.normal.cwiseAbs().maxCoeff(), 0.999);
    EXPECT_NEAR(patch.spacing / cube.spacing, 1, 5 / (2 * std::sqrt(double(patch.rows.size()))));
    for (const Index i : patch.rows) {
      // Of one face: the second largest coordinate is inside. A border of three cells, one of them cut.
      Vector3d sorted = cube.clean[i].cwiseAbs();
      std::sort(sorted.data(), sorted.data() + 3);
      EXPECT_LT(sorted[1], 1 - 5 * cube.spacing);
      squares += std::pow(patch.plane.height(cube.noisy[i]), 2);
      ++count;
    }
  }
  EXPECT_NEAR(std::sqrt(squares / count) / cube.sigma, 1, 5 / std::sqrt(count));
}

TEST(Flats, TheCreasesOfACubeAreItsEdges) {
  const NoisyCube cube;
  const Flats flats = find_flats(cube.noisy, 3);
  ASSERT_GT(flats.creases.size(), 12u);
  for (const Crease& crease : flats.creases) {
    EXPECT_LT(std::abs(crease.one.normal.dot(crease.other.normal)), 0.05);
    for (const Index i : crease.rows) {
      Vector3d sorted = cube.noisy[i].cwiseAbs();
      std::sort(sorted.data(), sorted.data() + 3);
      EXPECT_LT(std::hypot(sorted[1] - 1, sorted[2] - 1), 4 * cube.spacing);
    }
  }
}

TEST(Flats, ABallHasNone) {
  Positions ball = clouds::sample(*clouds::make_sphere(), 20000, 1, clouds::Sampling::uniform);
  clouds::add_noise(ball, 0.1 * std::sqrt(4 * 3.1416 / 20000), 2);
  EXPECT_TRUE(find_flats(ball, 3).patches.empty());
}

/// A square of unit spacing on z = 0 with a patch of all its points, and a crease that a wall would make.
struct Square {
  Positions points;
  Flats flats;
  Square() {
    Patch patch;
    patch.spacing = 1;
    for (int x = 0; x < 20; ++x)
      for (int y = 0; y < 20; ++y) {
        patch.rows.push_back(Index(points.size()));
        points.emplace_back(x, y, 0);
      }
    Crease crease;
    crease.spacing = 2;
    crease.other.normal = Vector3d::UnitX();
    crease.rows = {0, 1, 25};
    flats.patches = {patch};
    flats.creases = {crease};
  }
};

TEST(MeasureFlats, ALiftedSquareIsOffByItsLift) {
  const Square square;
  Positions lifted = square.points;
  for (Vector3d& p : lifted) p[2] += 0.5;
  const FlatError error = measure_flats(square.flats, 400, {lifted, {}}, {});
  EXPECT_DOUBLE_EQ(error.plane, 0.5);
  EXPECT_DOUBLE_EQ(error.normal, kLeastRough) << "it is flat";
  // Points 0 and 1 lie on the wall, point 25 is a spacing away from it and half a one above the floor.
  EXPECT_DOUBLE_EQ(error.crease, std::sqrt(0.25 / 3) / 2);
}

TEST(MeasureFlats, RowsMayComeInAnotherOrderAndMayLack) {
  const Square square;
  Cleaned cleaned;
  for (Index i = 400; i-- > 1;) {
    cleaned.points.push_back(square.points[i] + Vector3d(0, 0, 0.25));
    cleaned.source.push_back(i);
  }
  EXPECT_DOUBLE_EQ(measure_flats(square.flats, 400, cleaned, {}).plane, 0.25);
}

TEST(PlaneFit, FindsThePlaneUnderManyStrays) {
  clouds::Random random(1);
  Positions points;
  std::vector<Index> rows;
  const Vector3d normal = Vector3d(1, 2, 3).normalized();
  for (int i = 0; i < 1000; ++i) {
    Vector3d p = random.in_box(Vector3d::Constant(-1), Vector3d::Constant(1));
    if (i % 10 != 0) p -= normal.dot(p) * normal;  // one in ten is anywhere
    rows.push_back(Index(i));
    points.push_back(p);
  }
  const Plane drawn = draw_plane(points, rows, 100, random);
  EXPECT_LT(drawn.normal.cross(normal).norm(), 1e-9);
  EXPECT_LT(fit_plane_trimmed(points, rows).normal.cross(normal).norm(), 0.02);
  EXPECT_LT(robust_deviation(drawn, points, rows), 1e-9);
}

TEST(PlaneFit, ABowlIsNotFlatAndARoughPlaneIs) {
  clouds::Random random(1);
  Positions bowl, rough;
  std::vector<Index> rows;
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), noise = 0.05 * random.normal();
    bowl.emplace_back(x, y, 0.3 * (x * x + y * y) + noise);
    rough.emplace_back(x, y, noise);
    rows.push_back(Index(i));
  }
  EXPECT_FALSE(is_flat(fit_plane(bowl, rows), bowl, rows));
  EXPECT_TRUE(is_flat(fit_plane(rough, rows), rough, rows));
}

}  // namespace
}  // namespace rfsmooth::bench
