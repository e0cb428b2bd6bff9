/// Restores an invariant after every step of a flow: the volume of a closed mesh, the area of an open one, or
/// the volume between a height field and the plane z = 0.
///
///     p += t d,  t such that the invariant is what it was;  d_i = p_i - centroid (scaling), or e_z (height
///     field)
///
/// Desbrun et al. 1999, 3.1-3.2: without constraints this is their scaling by (V0/V)^(1/3), or (A0/A)^(1/2).
/// Differs from the paper: it scales about the origin, we about the centroid. Height fields are shifted,
/// since scaling them depends on the plane. Constrained vertices stay constrained (d is projected and scaled
/// with their strength), where the paper's scaling moves them.
///
/// For the volume faces are oriented first; an open, non-manifold or one-sided mesh is refused. If no t
/// restores the invariant, because of vertices that may not move, the step is a Failure (usage): an invariant
/// is never kept only approximately. A flow is for one thread at a time.
#pragma once

#include <memory>

#include "smoothing/modifiers/constraint.h"

namespace rfsmooth::smoothing {

/// Wraps a flow so that the mesh keeps `invariant`, which must not be none.
std::unique_ptr<Flow> make_preserving(std::unique_ptr<Flow> inner, const Mesh& mesh, Preserve invariant,
                                      AllowedMoves allowed, const Context& context);

}  // namespace rfsmooth::smoothing
