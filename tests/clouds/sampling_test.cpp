#include "clouds/shapes/sampling.h"

#include <cmath>

#include <gtest/gtest.h>

using namespace rfsmooth;
using namespace rfsmooth::clouds;

namespace {

double nearest_pair(const Positions& points) {
  double squared = INFINITY;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) squared = std::min(squared, (points[i] - points[j]).squaredNorm());
  return std::sqrt(squared);
}

TEST(Sampling, GivesTheNumberAskedForOnTheSurface) {
  for (const std::string_view name : shape_names()) {
    const auto shape = make_shape(name);
    for (const Sampling sampling : {Sampling::uniform, Sampling::poisson_disk}) {
      const Positions points = sample(*shape, 500, 1, sampling);
      EXPECT_EQ(points.size(), 500u);
      for (const auto& p : points) EXPECT_NEAR(shape->signed_distance(p), 0, 1e-12) << name;
    }
  }
}

TEST(Sampling, PoissonDiskKeepsPointsApart) {
  const auto torus = make_torus();
  const std::size_t n = 2000;
  // Yuksel reports minimum distances of 0.7 or more of the hexagonal packing's 2 x disk radius.
  const double packed = 2 * std::sqrt(torus->area() / (2 * std::sqrt(3.0) * double(n)));
  EXPECT_GT(nearest_pair(sample(*torus, n, 1, Sampling::poisson_disk)), 0.6 * packed);
  EXPECT_LT(nearest_pair(sample(*torus, n, 1, Sampling::uniform)), 0.2 * packed);
}

TEST(Sampling, DensityIsHonoured) {
  const auto sphere = make_sphere(9);
  for (const Sampling sampling : {Sampling::uniform, Sampling::poisson_disk}) {
    const Positions points = sample(*sphere, 5000, 1, sampling);
    double above = 0;
    for (const auto& p : points) above += p[2] >= 0;
    EXPECT_NEAR(above / 5000, 0.9, 0.02);
  }
}

TEST(Sampling, MeshAndShapeAgree) {
  const auto cube = make_cube();
  const Mesh mesh = cube->mesh(0.5);
  const Positions points = sample(mesh, 3000, 1);
  ASSERT_EQ(points.size(), 3000u);
  for (const auto& p : points) EXPECT_NEAR(cube->signed_distance(p), 0, 1e-12);
  EXPECT_NEAR(mean_spacing(points) / mean_spacing(sample(*cube, 3000, 1)), 1, 0.02);
}

TEST(Sampling, SameSeedSameBytes) {
  const auto part = make_l_part();
  Positions a = sample(*part, 1000, 5), b = sample(*part, 1000, 5);
  add_noise(a, 0.1, 6);
  add_noise(b, 0.1, 6);
  EXPECT_EQ(a, b);
  EXPECT_NE(a, sample(*part, 1000, 4));
}

TEST(Sampling, NoiseHasTheStandardDeviationAskedFor) {
  Positions points(100000, Eigen::Vector3d::Zero());
  add_noise(points, 0.02, 1);
  double squares = 0;
  for (const auto& p : points) squares += p.squaredNorm() / 3;
  EXPECT_NEAR(std::sqrt(squares / 100000), 0.02, 0.02 * 0.01);
}

TEST(Sampling, SpacingOfARegularGridIsItsStep) {
  Positions points;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) points.emplace_back(0.25 * i, 0.25 * j, 3);
  EXPECT_DOUBLE_EQ(mean_spacing(points), 0.25);
}

TEST(Sampling, TooFewCandidatesThrow) {
  EXPECT_THROW(eliminate(Positions(3, Eigen::Vector3d::Zero()), {}, 1, 4), std::invalid_argument);
}

}  // namespace
