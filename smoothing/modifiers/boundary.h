/// What any flow does at the boundary: the edges with exactly one face.
///
///     free     nothing special
///     fixed    boundary vertices stay
///     curve    boundary vertices smooth their curve; the flow sees them as fixed:
///              x += h^2/4 * 2/(d + D) [(x_- - x)/d + (x_+ - x)/D], d and D the lengths to both neighbours
///     virtual  each boundary loop is closed by a virtual vertex at its barycentre, seen by the flow only
///
/// Desbrun et al. 1999, 5.3 (curve: their (11) restricted to the two boundary neighbours; h = mean edge
/// length). Vertices where more than two boundary edges meet stay under "curve". The boundary is the one the
/// mesh has at the start; edge swaps do not change it.
/// A flow is for one thread at a time; the free functions are thread safe.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// Makes a flow on a mesh (perhaps the closed one) under constraints (perhaps with the boundary fixed).
using FlowMaker = std::function<std::unique_ptr<Flow>(const Mesh&, const Constraints&)>;

/// The flow that `make` makes, with the rule of that name.
std::unique_ptr<Flow> with_boundary_rule(const std::string& rule, const Mesh& mesh,
                                         const Constraints& constraints, const Context& context,
                                         const FlowMaker& make);

/// The edges with exactly one face, {a, b} as that face runs along them, ordered by (min, max).
std::vector<Edge> boundary_edges(const Mesh& mesh);

}  // namespace rfsmooth::smoothing
