#include "smoothing/integrators/chebyshev.h"

#include <cmath>

#include <gtest/gtest.h>

#include "smoothing/integrators/solver.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

double value(const std::vector<double>& coefficients, double k) {
  double sum = 0;
  for (std::size_t c = 0; c < coefficients.size(); ++c)
    sum += coefficients[c] * std::cos(double(c) * std::acos(std::min(1.0, std::max(-1.0, k - 1))));
  return sum;
}

TEST(Chebyshev, TheResidualIsAsSmallAsPromisedOnTheWholeSpectrum) {
  for (const double relative : {0.0, 0.1, 1.9})
    for (const double a2 : {0.1, 10.0, 4000.0})
      for (const double reduction : {0.3, 1e-2, 1e-6}) {
        const double a1 = relative * std::sqrt(a2);
        const auto p = inverse_polynomial(a1, a2, reduction, 4000);
        ASSERT_TRUE(p) << a1 << " " << a2;
        double largest = 0;
        for (int i = 0; i <= 2000; ++i) {
          const double k = i / 1000.0;
          largest = std::max(largest, std::abs(1 - (1 + a1 * k + a2 * k * k) * value(*p, k)));
        }
        EXPECT_LE(largest, reduction * (1 + 1e-6) + 1e-12) << a1 << " " << a2;
      }
}

TEST(Chebyshev, SaysSoWhenTheDegreeIsTooHighOrTheRootsAreReal) {
  EXPECT_FALSE(inverse_polynomial(0, 1e8, 1e-6, 100));
  EXPECT_FALSE(inverse_polynomial(200, 0.1, 1e-6, 1000));
}

// Vertices without neighbours, loose edges, two components: the same solution as conjugate gradients find.
TEST(Chebyshev, AgreesWithConjugateGradientsOnEveryMesh) {
  for (const auto& mesh : support::all_small()) {
    const Operator op = umbrella(mesh.one_ring, {});
    Fairing polynomial{mesh.one_ring, op};
    polynomial.a = {2, 500, 0, 0};
    Fairing iterated{mesh.one_ring, op};
    iterated.a = polynomial.a;
    iterated.strength.assign(mesh.positions.size(), 1);  // which the polynomial does not take
    SolverOptions options;
    options.tolerance = 1e-9;
    Positions x, y;
    EXPECT_TRUE(solve(polynomial, mesh.positions, x, {}, options, {}).converged);
    EXPECT_TRUE(solve(iterated, mesh.positions, y, {}, options, {}).converged);
    EXPECT_LT(support::rms_distance(x, y), 1e-7);
  }
}

// A mass that is not the degree is not the umbrella.
TEST(Chebyshev, OtherMassesAreSolvedToo) {
  const auto mesh = support::icosphere(2);
  Operator op = umbrella(mesh.one_ring, {});
  for (std::size_t i = 0; i < op.mass.size(); ++i) op.mass[i] *= 1 + 0.1 * double(i % 3);
  Fairing system{mesh.one_ring, op};
  system.a = {0, 30, 0, 0};
  Positions x, level, y;
  SolverOptions options;
  options.tolerance = 1e-10;
  ASSERT_TRUE(solve(system, mesh.positions, x, {}, options, {}).converged);
  apply(mesh.one_ring, op, x, level, {});
  apply(mesh.one_ring, op, level, y, {});
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((x[i] + 30 * y[i] - mesh.positions[i]).norm(), 1e-8);
}

}  // namespace
