/// What any flow does at the boundary: the edges with exactly one face.
///
///     free     nothing special
///     fixed    boundary vertices stay
///     curve    boundary vertices follow the same flow, with the same step, along their curve: they see only
///              their two neighbours on it. Flows of umbrellas (laplacian, hc, hc-limit, taubin, bilaplacian)
///              do so as they are; the others take the 1-D scale-dependent operator instead of theirs,
///              (L x)_i = 2/(d + D) [(x_i - x_-)/d + (x_i - x_+)/D], d and D the lengths to both neighbours:
///              implicit ones solve with dt and the order of theirs, explicit ones step by lambda h^2
///     virtual  each boundary loop is closed by a virtual vertex, at first at its barycentre, that the flow
///              moves like any other; its edges do not count for the mean edge length
///
/// Desbrun et al. 1999, 5.3 (curve: their (11) restricted to the two boundary neighbours; h = mean edge
/// length of the boundary). Implicit flows solve for the rest with the boundary where it goes to, explicit
/// ones step from where it was. Vertices where other than two boundary edges meet stay under "curve". The
/// boundary is the one the mesh has at the start; edge swaps do not change it.
/// A flow is for one thread at a time; the free functions are thread safe.
#pragma once

#include <memory>

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// The flow that `make` makes (perhaps on the closed mesh, perhaps with the boundary fixed), with the rule of
/// the options.
std::unique_ptr<Flow> with_boundary_rule(const FlowOptions& options, const Mesh& mesh,
                                         const Constraints& constraints, const Context& context,
                                         const FlowMaker& make);

/// The edges with exactly one face, {a, b} as that face runs along them, ordered by (min, max).
std::vector<Edge> boundary_edges(const Mesh& mesh);

}  // namespace rfsmooth::smoothing
