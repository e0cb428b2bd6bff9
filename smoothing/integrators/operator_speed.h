/// The speed that an operator gives: of the curvature operator that of mean curvature flow, H n, inward on a
/// sphere, times h^2 (h = mean edge length).
///
///     F = -unit L q
///
/// Desbrun et al. 1999, (14) and 5.5; Ohtake, Belyaev, Bogaevski 2000, (7), (8). Differs from the papers: the
/// mixed area makes the curvature operator H n where theirs is H n / 3; and a vertex whose own explicit limit
/// (its weights over its mass, at needles) is below the step moves by that limit only, so a bad triangle
/// cannot blow up the flow. Scheme::printed does neither. A speed is for one thread at a time.
#pragma once

#include <memory>

#include "smoothing/integrators/explicit.h"

namespace rfsmooth::smoothing {

/// Weights are taken from the current positions at every step. \param lambda the step that the speed will be
/// multiplied with; vertices are limited to lambda unit sum|w| / m <= 1.
std::unique_ptr<Speed> make_operator_speed(OperatorKind kind, double lambda, Scheme scheme);

}  // namespace rfsmooth::smoothing
