#include "smoothing/operators/divided_difference.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/fairing_energy.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

/// The field x -> f(x) as the first coordinate of n vectors.
template <class F>
Positions field(const Mesh& mesh, F&& f) {
  Positions y;
  for (const Vector3d& p : mesh.positions) y.emplace_back(f(p), 0, 0);
  return y;
}

class EveryChart : public testing::TestWithParam<Chart> {};
INSTANTIATE_TEST_SUITE_P(Charts, EveryChart,
                         testing::Values(Chart::tangent, Chart::exponential, Chart::mixed, Chart::uniform));

TEST_P(EveryChart, ConstantsHaveNoEnergyAndNothingIsNegative) {
  for (Mesh& mesh : support::all_small()) {
    const DividedDifferences d(mesh, GetParam(), {});
    EXPECT_LT(support::energy(d, field(mesh, [](const Vector3d&) { return 3.0; })), 1e-20);
    const Positions x = field(mesh, [](const Vector3d&p) { return std::sin(3 * p.x()) + p.y() * p.z(); }),
                    y = field(mesh, [](const Vector3d&p) { return p.x() * p.x() - p.y(); });
    const double of_x = support::energy(d, x), of_y = support::energy(d, y);
    EXPECT_GE(of_x, 0);
    EXPECT_GE(of_y, 0);
    EXPECT_NEAR(support::form(d, x, y), support::form(d, y, x), 1e-9 * (of_x + of_y)) << "symmetric";
    const std::vector<double> diagonal = d.diagonal({});
    ASSERT_EQ(diagonal.size(), x.size());
    for (const double v : diagonal) EXPECT_GE(v, 0);
  }
}

TEST_P(EveryChart, LinearFunctionsOfARegularPlaneHaveNoEnergy) {
  const Mesh mesh = support::grid(9, 8, true);
  const DividedDifferences d(mesh, GetParam(), {});
  EXPECT_LT(support::energy(d, field(mesh, [](const Vector3d& p) { return 2 * p.x() - p.y(); })), 1e-6);
}

TEST(DividedDifferences, SecondDerivativesOfAQuadraticAreExact) {
  Mesh mesh = support::grid(60, 50);
  support::add_noise(mesh, 0.1, 3);
  for (Vector3d& p : mesh.positions) p.z() = 0;
  const DividedDifferences d(mesh, Chart::tangent, {});
  const Positions x =
      field(mesh, [](const Vector3d& p) { return 3 * p.x() * p.x() - p.x() * p.y() + 0.5 * p.y() * p.y(); });
  // |f_uu|^2 + 2 |f_uv|^2 + |f_vv|^2 = 36 + 2 + 1, in units of the mean edge: h^4 times that over area / h^2.
  const double h = support::mean_edge(mesh);
  double interior = 0, total = 0;
  for (const double w : d.weights()) total += w;
  interior = support::energy(d, x) / (total * std::pow(h, 4));
  EXPECT_NEAR(interior, 39, 0.05 * 39) << "boundary vertices of low valence fall short";
}

/// Rows added to a regular sheet add interior vertices alone, up to what its rim adds linearly.
TEST(DividedDifferences, TheRidgeIsNotFeltWhereTheFitIsDetermined) {
  const auto energy = [](int side) {
    const Mesh mesh = support::grid(side, side, true);
    return support::energy(DividedDifferences(mesh, Chart::tangent, {}), field(mesh, [](const Vector3d& p) {
                             return 3 * p.x() * p.x() - p.x() * p.y() + 0.5 * p.y() * p.y();
                           }));
  };
  const double interior = (energy(12) - 2 * energy(11) + energy(10)) / 2;
  EXPECT_NEAR(interior, 39 * std::sqrt(0.75), 1e-5 * 39);
}

TEST(DividedDifferences, TheDiagonalIsTheMatrixs) {
  const Mesh mesh = support::icosphere(1);
  const DividedDifferences d(mesh, Chart::mixed, {});
  const std::vector<double> diagonal = d.diagonal({});
  for (const std::size_t i : {0u, 5u, 20u, 41u}) {
    Positions unit(mesh.positions.size(), Vector3d::Zero()), y;
    unit[i].x() = 1;
    d.apply(unit, y, {});
    EXPECT_NEAR(y[i].x(), diagonal[i], 1e-10 * diagonal[i]);
  }
}

}  // namespace
