/// Cuts a surface apart where it touches itself.
///
/// Where faces meet at an edge of more than two, or at a vertex whose faces form several fans, each fan gets
/// its own copy of the vertex. The surface is then a manifold, and no face is lost. Around a crowded edge the
/// faces alternate, back to back and front to front. Two faces whose backs face each other stay together,
/// because the inside lies between them; so two solids that touch come apart. Where the fans at both ends of
/// the edge are still connected, faces whose fronts face each other stay together instead. Gueziec, Taubin,
/// Lazarus and Horn 2001, "Cutting and stitching: converting sets of polygons to manifold surfaces".
#pragma once

#include <cstddef>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::pipeline {

/// Copies vertices until every edge has at most two faces, which agree, and every vertex one fan (three
/// rounds; edges that depend on each other may be left, rarely). The copies come after the other vertices.
/// Faces keep their order and orientation; faces that run along an edge in the same direction come apart
/// there. Returns the number of copies; the adjacency is rebuilt if there are any. O(m log m), one thread,
/// deterministic.
std::size_t part_pinches(Mesh& mesh, const Context& context);

}  // namespace rfsmooth::pipeline
