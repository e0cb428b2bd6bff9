/// An adaptive threshold T over a flow: vertices whose speed is below T stay, the others move by the excess.
/// Smoothing slows down and stops by itself.
///
///     move by lambda (|F| - T) F / |F| where |F| > T, else stay
///
/// Ohtake, Belyaev, Bogaevski 2000, (14). F = (p - q) / lambda, the move of the wrapped step per unit of its
/// step length. T is constant, or the mean curvature of the surroundings, recomputed every few steps: the
/// mean of h^2 |H| over the first, or first and second, ring of neighbours without the vertex itself; h^2 |H|
/// (h = mean edge length) is the speed that mean curvature flow has there. At rims, where |H| has no meaning
/// (Desbrun 5.3), the part along the normal counts; in the printed scheme |H| is what (8) gives everywhere.
/// A flow is for one thread at a time.
#pragma once

#include <memory>

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// Where the threshold comes from.
struct ThresholdRule {
  int rings = 0;                 ///< 0 = constant, 1 or 2 = mean curvature of that many rings
  double constant = 0.1;         ///< T of the constant rule, x mean edge length of the first mesh
  int every = 5;                 ///< steps between recomputing the ring means
  double lambda = 1;             ///< the wrapped flow's step length
  Scheme scheme = Scheme::safe;  ///< the wrapped flow's, of |H| too
};

/// Wraps a flow by the rule.
std::unique_ptr<Flow> make_threshold(std::unique_ptr<Flow> inner, const Mesh& mesh, const ThresholdRule& rule,
                                     const Context& context);

}  // namespace rfsmooth::smoothing
