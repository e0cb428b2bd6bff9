/// The inverse of 1 + a1 k + a2 k^2 as a polynomial in k, for operators whose spectrum lies in [0, 2]: one
/// pass over the vectors per degree and no dot products, where conjugate gradients take four passes for two.
///
///     p(k) = (1 - q(k)) / (1 + a1 k + a2 k^2),   q = a T_m + b T_(m-1) in t = k - 1,   q = 1 at both roots
///
/// x = p(L) b leaves the residual q(L) b, in L's own norm at most |a| + |b| times as large. q is the
/// classical Chebyshev iteration's residual, with two numbers to meet the two roots (Manteuffel 1977 for
/// one). Thread safe: no state is kept.
#pragma once

#include <optional>
#include <vector>

#include "smoothing/integrators/conjugate_gradients.h"

namespace rfsmooth::smoothing {

/// p's coefficients in the basis T_0(t), T_1(t), ...: the fewest such that the residual falls to `reduction`;
/// none if that takes a degree above `most`, or if the roots are real or nearly (a1^2 > 3.9 a2), where
/// meeting both loses digits and the first power rules anyway. a1 >= 0, a2 > 0.
std::optional<std::vector<double>> inverse_polynomial(double a1, double a2, double reduction, int most);

/// d = p(L) v with L the umbrella (I - the neighbours' mean; zero at vertices without neighbours). v is
/// overwritten.
void apply_polynomial(const std::vector<double>& coefficients, const Adjacency& rows,
                      Vectors<Eigen::Vector4f>& v, Vectors<Eigen::Vector4f>& d, const Context& context);

}  // namespace rfsmooth::smoothing
