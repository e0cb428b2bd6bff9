/// Meshes in files: a Cloud whose PLY or OFF file also has faces (or edges). The polygons stay in the cloud
/// unchanged. Here they are read as triangles to work on, and triangles and edges are put into a cloud to
/// write. Thread safe on distinct clouds; O(what is read or written).
#pragma once

#include <rfsmooth/mesh.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// The field of an element that lists the corners of polygons (vertex_indices or vertex_index), if any.
std::optional<std::size_t> polygon_field(const Table& table);

/// The triangles of a PLY or OFF file (m x 3), corners as rows of the points; empty if the file has no faces.
/// Polygons are split into fans: a fan covers a convex polygon; of others, only the connectivity is right.
/// Polygons with fewer than three corners and triangles with a repeated corner are left out; a warning says
/// how many, and the file keeps them. \throw Failure (input_unreadable) naming a face with a point that does
/// not exist.
std::vector<Face> faces_of(const Cloud& cloud, const Context& context = {});

/// The edges of a PLY file (element edge with vertex1 and vertex2), lower index first, without edges from a
/// point to itself. \throw Failure as above.
std::vector<Edge> edges_of(const Cloud& cloud, const Context& context = {});

/// Replaces the element 'face' by triangles (list uchar int vertex_indices). Rows are binary. Only PLY and
/// OFF can carry faces: set cloud.format, or write in that format.
void set_faces(Cloud& cloud, const std::vector<Face>& faces);
/// Replaces the element 'edge' (int vertex1, int vertex2), which only PLY can carry. `kind`: one per edge,
/// written as uchar kind; or empty.
void set_edges(Cloud& cloud, const std::vector<Edge>& edges, const std::vector<std::uint8_t>& kind = {});

/// A binary PLY of points (float64), triangles and edges; elements without rows are left out.
Cloud make_mesh_file(const Positions& points, const std::vector<Face>& faces, const std::vector<Edge>& edges,
                     const std::vector<std::uint8_t>& kind = {});

}  // namespace rfsmooth::pipeline::io
