/// Holes of three edges: triangles of the mesh's own edges that no face fills.
///
/// The paper's RFS-mesh has as many faces as a valid mesh has (Vollmer et al. section 7). Where the umbrellas
/// of three neighbours each chose other faces, and these lost at other edges, all three edges between them
/// can be left with one face each: a hole that needs no new edge. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::rfs_mesh {

/// Appends a face for every three vertices whose three edges all have one face now, if its quality is at
/// least `quality` and it is folded at none of the edges (the dihedral angle is at least a right one). Of two
/// that want the same edge the one of better quality gets it, ties by index. No edge has more than two faces
/// afterwards, and the edges are the same as before. New faces run against the neighbour at their first edge.
/// O(n), nearly all of it parallel; deterministic.
void fill_small_holes(const Positions& at, double quality, std::vector<Face>& faces, const Context& context);

}  // namespace rfsmooth::rfs_mesh
