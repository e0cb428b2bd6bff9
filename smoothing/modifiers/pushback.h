/// The second half of HC, after a step of any kind: pushes the new points back towards the previous and the
/// original ones.
///
///     b_i = p_i - (alpha o_i + (1 - alpha) q_i),   p_i -= beta b_i + (1 - beta) mean_j b_j
///
/// Vollmer, Mencl, Mueller 1999, sections 4 and 6. o is the original position, q the one before the step, p
/// the one after it. Vertices without neighbours stay (section 2). Constraints hold for the correction too,
/// and must have held for the step: then b of a fixed vertex is zero. O(edges), parallel. A flow is for one
/// thread at a time.
#pragma once

#include <memory>

#include "smoothing/modifiers/constraint.h"

namespace rfsmooth::smoothing {

/// Wraps `inner`, which must apply any constraints itself. The mesh's current positions are the original
/// points o.
std::unique_ptr<Flow> make_pushback(std::unique_ptr<Flow> inner, const Mesh& mesh, double alpha, double beta,
                                    AllowedMoves allowed);

}  // namespace rfsmooth::smoothing
