/// Faces and edges of a file, and the file of a mesh: the bridge between io's Cloud and rfs_mesh's Mesh.
#pragma once

#include <vector>

#include "rfsmooth/pipeline/io/cloud.h"
#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/mesh.h"

namespace rfsmooth::pipeline::io {

/// The triangles of a PLY or OFF file, rows of the points as corners; polygons are cut into fans, faces of
/// one or two corners are left out. Empty if the file has no faces. \throw Failure (input_unreadable) naming
/// the face that asks for a point that does not exist. O(faces).
std::vector<rfs_mesh::Face> faces_of(const Cloud& cloud, const Context& context = {});

/// The edges of a PLY file (element edge with vertex1 and vertex2), smaller index first; a == b is left out.
/// \throw Failure as above.
std::vector<rfs_mesh::Edge> edges_of(const Cloud& cloud, const Context& context = {});

/// A binary PLY of points (float64), triangles and edges; elements without rows are left out.
Cloud make_mesh_file(const Positions& points, const std::vector<rfs_mesh::Face>& faces,
                     const std::vector<rfs_mesh::Edge>& edges);

}  // namespace rfsmooth::pipeline::io
