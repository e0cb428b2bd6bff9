/// Closes the small holes of a surface, and only those.
///
/// A hole is filled by the triangulation of its rim, without new vertices, that has the least area (Barequet
/// and Sharir 1995, "Filling gaps in the boundary of a polyhedron"). Its new edges must be at most
/// `longest_edge` long and not yet edges of the surface. A slit between measured points has such a
/// triangulation; a gap that nobody measured has none and stays open. So does the outline of a sheet, however
/// narrow: its filling would be a second sheet. A manifold stays one.
#pragma once

#include <cstddef>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::pipeline {

/// Appends the faces, oriented as their neighbours, and rebuilds the adjacency; returns how many holes were
/// filled. Holes of more than 1,000 edges, rims that pass a vertex twice, and those whose filling would have
/// more than sqrt(1/2) of the area of their piece, are left alone. `longest_edge`: world units. Precondition:
/// faces agree across every edge. O(m log m + k^3) for rims of k edges; one thread, deterministic; polls
/// `context` between holes.
std::size_t fill_holes(Mesh& mesh, double longest_edge, const Context& context);

}  // namespace rfsmooth::pipeline
