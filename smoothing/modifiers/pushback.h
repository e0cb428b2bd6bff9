/// The second half of HC, on whatever step came before it: pushes the new points back towards the previous
/// and the original ones.
///
///     b_i = p_i - (alpha o_i + (1 - alpha) q_i),   p_i -= beta b_i + (1 - beta) mean_j b_j
///
/// Vollmer, Mencl, Mueller 1999, sections 4 and 6. o original, q before the step, p after it; vertices
/// without neighbours stay where they are (section 2). Constraints hold for the correction too, and must have
/// held for the step before it: then b of a fixed vertex is zero. O(edges), parallel.
/// A flow is for one thread at a time.
#pragma once

#include <memory>

#include "smoothing/modifiers/constraint.h"

namespace rfsmooth::smoothing {

/// Wraps `inner`, which applies the constraints itself if there are any; the mesh's current positions are the
/// original points o.
std::unique_ptr<Flow> make_pushback(std::unique_ptr<Flow> inner, const Mesh& mesh, double alpha, double beta,
                                    AllowedMoves allowed);

}  // namespace rfsmooth::smoothing
