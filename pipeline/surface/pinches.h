/// Cutting a surface apart where it touches itself.
///
/// Faces that meet at an edge of more than two, or at a vertex whose faces make several fans, leave one
/// vertex for each fan, at the same place: the surface is then a manifold, and no face is lost. At a crowded
/// edge the faces go round it in turns, back to back and front to front; those that look at each other with
/// their backs (what is inside lies between them) stay together, so that two solids that touch come apart,
/// and where both ends of the edge hang together all the same, those that look at each other with their
/// fronts: Gueziec, Taubin, Lazarus and Horn 2001, "Cutting and stitching: converting sets of polygons to
/// manifold surfaces".
#pragma once

#include <cstddef>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::pipeline {

/// Copies vertices and renames corners until every edge has at most two faces, which agree, and every vertex
/// one fan; new vertices come after the others. Faces keep their order and orientation; faces that run along
/// an edge in the same direction come apart there. Returns the number of vertices added. The adjacency is
/// rebuilt if there are any. O(m log m), one thread, deterministic.
std::size_t part_pinches(Mesh& mesh, const Context& context);

}  // namespace rfsmooth::pipeline
