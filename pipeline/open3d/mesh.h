/// The RFS-mesh, and any mesh of ours, as Open3D's `TriangleMesh`: to look at, or to go on with.
#pragma once

#include <memory>

#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/mesh.h"
#include "rfsmooth/rfs_mesh/result.h"
#include "rfsmooth/rfs_mesh/rfs_mesh.h"

namespace open3d::geometry {
class PointCloud;
class TriangleMesh;
}  // namespace open3d::geometry

namespace rfsmooth::open3d {

/// Vertices and triangles as they are, in order; loose edges have no counterpart. With `turn` the triangles
/// are turned so that neighbours agree as far as the mesh has two sides, and closed parts face outward: a
/// viewer that hides back faces then shows no holes that are not there. The caller's frame is the mesh's. O(n
/// + m).
std::shared_ptr<::open3d::geometry::TriangleMesh> to_triangle_mesh(const rfs_mesh::Mesh& mesh,
                                                                   bool turn = true);

/// The RFS-mesh that denoising works on, of a cloud's finite, distinct points in their order, turned as by
/// `to_triangle_mesh`, with the points' colours and, on the points, the mesh's normals. For viewing: the
/// RFS-mesh may cross itself and have holes.
/// Errors: usage (options), no_usable_points, out_of_memory, cancelled. O(n log n).
Result<std::shared_ptr<::open3d::geometry::TriangleMesh>> rough_mesh(
    const ::open3d::geometry::PointCloud& cloud, const rfs_mesh::ConnectOptions& options = {},
    const Context& context = {});

}  // namespace rfsmooth::open3d
