/// The speed of Laplacian smoothing: from each vertex to the (weighted) mean of its neighbours.
///
///     F(q_i) = sum_j w_ij q_j / sum_j w_ij - q_i,   w_ij = 1 (U0) or 1 / |q_i - q_j| (U1)
///
/// Vollmer, Mencl, Mueller 1999, section 3.1; Ohtake, Belyaev, Bogaevski 2000, (1)-(4).
/// A speed is for one thread at a time.
#pragma once

#include <memory>

#include <rfsmooth/flow_options.h>

#include "smoothing/integrators/explicit.h"

namespace rfsmooth::smoothing {

/// Weights are taken from the current positions at every step. Vertices without neighbours stay. Neighbours
/// at the vertex itself have no finite U1: they are left out there, so that they do not hold the vertex where
/// it is, and a vertex that has no others stays. U0 counts them like all others.
std::unique_ptr<VertexSpeed> make_umbrella_speed(UmbrellaWeights weights);

}  // namespace rfsmooth::smoothing
