/// The speed of Laplacian smoothing: from each vertex to the (weighted) mean of its neighbours.
///
///     F(q_i) = sum_j w_ij q_j / sum_j w_ij - q_i,   w_ij = 1 (U0) or 1 / |q_i - q_j| (U1)
///
/// Vollmer, Mencl, Mueller 1999, section 3.1; Ohtake, Belyaev, Bogaevski 2000, (1)-(4).
/// A speed is for one thread at a time.
#pragma once

#include <memory>

#include "smoothing/integrators/explicit.h"

namespace rfsmooth::smoothing {

/// Weights are taken from the current positions at every step. Vertices without neighbours stay.
std::unique_ptr<Speed> make_umbrella_speed(bool inverse_distance);

}  // namespace rfsmooth::smoothing
