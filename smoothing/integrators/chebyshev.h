/// The inverse of 1 + a1 k + a2 k^2 as a polynomial in k, for operators whose spectrum lies in [0, 2]. It
/// needs one pass over the vectors per degree and no dot products; conjugate gradients need four passes for
/// two degrees.
///
///     p(k) = (1 - q(k)) / (1 + a1 k + a2 k^2),   q = a T_m + b T_(m-1) in t = k - 1,   q = 1 at both roots
///
/// p(L) v leaves the residual q(L) v, in L's own norm at most |a| + |b| times as large as v. q is the
/// residual of the classical Chebyshev iteration (Manteuffel 1977, for one root), with two coefficients to
/// meet the two roots. Thread safe: no state is kept.
#pragma once

#include <optional>
#include <vector>

#include "smoothing/integrators/conjugate_gradients.h"

namespace rfsmooth::smoothing {

/// The coefficients of p in the basis T_0(t), T_1(t), ...: the fewest that reduce the residual to
/// `reduction`. None if the degree would be above `most`, or if the roots are real or nearly so (a1^2 > 3.9
/// a2): meeting both then loses digits, and the first power dominates. a1 >= 0, a2 > 0.
std::optional<std::vector<double>> inverse_polynomial(double a1, double a2, double reduction, int most);

/// d = p(L) v, L the umbrella (I - mean of the neighbours; zero without neighbours). `coefficients`: of
/// inverse_polynomial. v and d have a row for each of `rows`; v is overwritten. Parallel, O(edges) for each
/// coefficient.
void apply_polynomial(const std::vector<double>& coefficients, const Adjacency& rows,
                      Vectors<Eigen::Vector4f>& v, Vectors<Eigen::Vector4f>& d, const Context& context);

}  // namespace rfsmooth::smoothing
