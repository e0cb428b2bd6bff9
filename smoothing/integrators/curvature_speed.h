/// The speed of mean curvature flow: H n, inward on a sphere, times h^2 (h = mean edge length).
///
///     F = -h^2 L q   with L the curvature operator, or -L q with its normalised version
///
/// Desbrun et al. 1999, (14) and 5.5; Ohtake, Belyaev, Bogaevski 2000, (7), (8). Differs from the papers: the
/// mixed area makes the operator H n where theirs is H n / 3; and a vertex whose own explicit limit (its
/// weights over its area, at needles) is below the step moves by that limit only, so a bad triangle cannot
/// blow up the flow. Scheme::printed does neither. A speed is for one thread at a time.
#pragma once

#include <memory>

#include "smoothing/integrators/explicit.h"

namespace rfsmooth::smoothing {

/// \param lambda the step it will be multiplied with; vertices are limited to lambda h^2 sum|w| / m <= 1.
std::unique_ptr<Speed> make_curvature_speed(bool normalised, double lambda, Scheme scheme);

}  // namespace rfsmooth::smoothing
