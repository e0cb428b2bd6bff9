#include "rfs_mesh/normals/winding.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace rfsmooth::rfs_mesh {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kPoints = 3000;
constexpr double kSoft = 0.05;

double direct(const Positions& points, const Positions& m, std::size_t i) {
  double sum = 0;
  for (std::size_t j = 0; j < points.size(); ++j) {
    const Vector3d r = points[j] - points[i];
    sum += m[j].dot(r) / std::pow(r.squaredNorm() + kSoft * kSoft, 1.5) / (4 * M_PI);
  }
  return sum;
}

TEST(Winding, IsNearTheDirectSum) {
  const Positions points = test::random_points(test::unit_sphere(), kPoints, 1);
  Positions m;
  for (const auto& p : points)
    m.emplace_back(4 * M_PI / double(points.size()) * Vector3d(p + Vector3d(0, 0, p[0])));
  const auto w = Winding(points, kSoft, {}).numbers(m, {});
  ASSERT_EQ(w.size(), points.size());
  for (std::size_t i = 0; i < points.size(); i += 7) EXPECT_NEAR(w[i], direct(points, m, i), 0.06);
}

TEST(Winding, IsTheDirectSumWithinALeafAndFieldIsItsAdjoint) {
  const Positions points = test::random_points(test::unit_sphere(), KdTree::kLeaf, 1);
  std::vector<double> c;
  Positions m;
  for (const auto& p : points) {
    c.push_back(1 + p[0] * p[1]);
    m.emplace_back(p[1], -0.3, p[0] * p[2]);
  }
  const Winding winding(points, kSoft, {});
  const auto w = winding.numbers(m, {});
  const Positions e = winding.field(c, {});
  double left = 0, right = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(w[i], direct(points, m, i), 1e-12);
    left += c[i] * w[i];
    right += e[i].dot(m[i]);
  }
  EXPECT_NEAR(left, right, 1e-12);
}

TEST(Winding, IsOneHalfOnASphereWithOutwardNormals) {
  const Positions points = test::poisson_points(test::unit_sphere(), kPoints, 1);
  Positions m;
  for (const auto& p : points) m.emplace_back(4 * M_PI / double(points.size()) * p);
  const std::vector<double> numbers = Winding(points, 0.03, {}).numbers(m, {});
  ASSERT_EQ(numbers.size(), points.size());
  for (const double w : numbers) EXPECT_NEAR(w, 0.5, 0.08);
}

TEST(Winding, GaussFindsTheSideOfATorusFromItsPointsAlone) {
  const Positions points = test::poisson_points(test::torus(), kPoints, 1);
  const Positions m = Winding(points, 0.05, {}).gauss(4, {});
  std::size_t outward = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d ring = Vector3d(points[i][0], points[i][1], 0).normalized();
    outward += m[i].dot(points[i] - ring) > 0 ? 1 : 0;
  }
  EXPECT_GT(double(outward), 0.99 * double(points.size()));
}

TEST(Winding, TakesNoPointsAndRefusesNoSoftening) {
  const Positions none;
  EXPECT_TRUE(Winding(none, 1, {}).numbers({}, {}).empty());
  EXPECT_TRUE(Winding(none, 1, {}).gauss(3, {}).empty());
  EXPECT_THROW(Winding(none, 0, {}), std::invalid_argument);
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
