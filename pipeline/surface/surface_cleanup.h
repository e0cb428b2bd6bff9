/// Last steps after a reconstruction: drop faces and pieces without data, and find each vertex's point.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::pipeline {

/// Drops the faces with a corner farther than `length` (world units) from all of the n points, then the
/// vertices without faces: Poisson reconstruction closes every gap, however wide, with surface that nobody
/// measured. `points` must not be empty. O(m log n), parallel, deterministic.
void trim_far_faces(Mesh& mesh, const Positions& points, double length, const Context& context);

/// Drops the pieces (connected through vertices) of fewer than `least` faces, unless all are so small; then
/// the vertices without faces.
void drop_specks(Mesh& mesh, std::size_t least, const Context& context);

/// Drops the vertices without faces, and all loose edges. The others keep their order.
void drop_unused_vertices(Mesh& mesh, const Context& context);

/// The nearest of the n points to each vertex of the mesh, whose colour and fields it takes.
std::vector<Index> nearest_points(const Mesh& mesh, const Positions& points, const Context& context);

}  // namespace rfsmooth::pipeline
