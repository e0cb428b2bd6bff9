/// What a flow does at the boundary, the edges with exactly one face:
///
///     free     nothing special
///     fixed    boundary vertices stay
///     curve    boundary vertices follow the flow along their curve, with the same step: they see only their
///              two neighbours on it
///     virtual  each boundary loop is closed by a virtual vertex, at first at its barycentre, that the flow
///              moves like any other; its edges do not count for the mean edge length
///
/// Desbrun et al. 1999, 5.3. Along a curve, flows of umbrellas (laplacian, hc, hc-limit, taubin, bilaplacian)
/// run unchanged. The others take the 1-D scale-dependent operator, their (11) restricted to the two boundary
/// neighbours,
///
///     (L x)_i = 2/(d + D) [(x_i - x_-)/d + (x_i - x_+)/D],    d, D the lengths to both neighbours.
///
/// Implicit flows solve with their own dt and order; explicit ones step by lambda h^2 (automatic: by h^2 /
/// 4), h the mean edge length of the boundary. Then implicit flows solve for the interior with the boundary
/// at its new place; explicit ones step from its old place. Vertices with other than two boundary edges stay
/// under "curve". The boundary is that of the mesh at the start; edge swaps do not change it. A flow is for
/// one thread at a time; the free functions are thread safe.
#pragma once

#include <memory>

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// The flow that `make` makes, on the closed mesh or with the boundary fixed if need be, with the boundary
/// rule of the options. \throw std::invalid_argument for constraints that do not fit the mesh.
std::unique_ptr<Flow> with_boundary_rule(const FlowOptions& options, const Mesh& mesh,
                                         const Constraints& constraints, const Context& context,
                                         const FlowMaker& make);

/// The edges with exactly one face, {a, b} in the direction of that face, ordered by (min, max).
std::vector<Edge> boundary_edges(const Mesh& mesh);

}  // namespace rfsmooth::smoothing
