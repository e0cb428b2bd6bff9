/// The RFS-mesh, and any mesh of ours, as Open3D's `TriangleMesh`: to look at, or to go on with. Thread safe:
/// no state is kept.
#pragma once

#include <memory>

#include <rfsmooth/connect.h>
#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>
#include <rfsmooth/result.h>

namespace open3d::geometry {
class PointCloud;
class TriangleMesh;
}  // namespace open3d::geometry

namespace rfsmooth::open3d {

/// Vertices and triangles in order, in the mesh's frame; loose edges have no counterpart. With `normals` (one
/// per vertex) each triangle is turned to the side of its corners' normals, which become the vertices': a
/// viewer that hides back faces then shows no holes that are not there. O(n + m). \throw
/// std::invalid_argument for normals of another number, std::length_error from 2^31 vertices on, which Open3D
/// does not count.
std::shared_ptr<::open3d::geometry::TriangleMesh> to_triangle_mesh(const Mesh& mesh,
                                                                   const Positions& normals = {});

/// The RFS-mesh that denoising works on, of a cloud's finite, distinct points in their order, with their
/// colours and with normals on one side. For viewing: the RFS-mesh may cross itself and have holes. Errors:
/// usage (options), no_usable_points, out_of_memory, cancelled. O(n log n).
Result<std::shared_ptr<::open3d::geometry::TriangleMesh>> rough_mesh(
    const ::open3d::geometry::PointCloud& cloud, const ConnectOptions& options = {},
    const Context& context = {});

}  // namespace rfsmooth::open3d
