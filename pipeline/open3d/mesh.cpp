#include "rfsmooth/open3d/mesh.h"

#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>

#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/smoothing/surface.h"

namespace rfsmooth::open3d {

using ::open3d::geometry::PointCloud;
using ::open3d::geometry::TriangleMesh;

std::shared_ptr<TriangleMesh> to_triangle_mesh(const rfs_mesh::Mesh& mesh, bool turn) {
  auto made = std::make_shared<TriangleMesh>();
  made->vertices_ = mesh.positions;
  made->triangles_.reserve(mesh.faces.size());
  for (const rfs_mesh::Face& f : turn ? smoothing::oriented_as_far_as_possible(mesh) : mesh.faces)
    made->triangles_.emplace_back(int(f[0]), int(f[1]), int(f[2]));
  return made;
}

Result<std::shared_ptr<TriangleMesh>> rough_mesh(const PointCloud& cloud,
                                                 const rfs_mesh::ConnectOptions& options,
                                                 const Context& context) {
  const std::size_t n = cloud.points_.size();
  const auto working =
      rfs_mesh::make_working_cloud(n == 0 ? nullptr : cloud.points_.front().data(), n, context);
  if (!working.ok()) return working.error();
  auto connection = [&] {
    std::optional<Result<rfs_mesh::Connection>> made;
    in_arena(context, [&] { made.emplace(rfs_mesh::connect(working.value().points, options, context)); });
    return std::move(*made);
  }();
  if (!connection.ok()) return connection.error();

  // The working points in the order in which the cloud has them first, at the cloud's own coordinates.
  rfs_mesh::Mesh mesh;
  std::vector<std::size_t> row;
  std::vector<Index> rank(working.value().points.size(), kNone);
  for (std::size_t i = 0; i < n; ++i) {
    const Index p = working.value().of_input[i];
    if (p == kNone || rank[p] != kNone) continue;
    rank[p] = Index(row.size());
    row.push_back(i);
    mesh.positions.push_back(cloud.points_[i]);
  }
  mesh.faces = std::move(connection.value().mesh.faces);
  for (auto& face : mesh.faces)
    for (Index& corner : face) corner = rank[corner];

  auto made = to_triangle_mesh(mesh);
  if (cloud.HasColors())
    for (const std::size_t i : row) made->vertex_colors_.push_back(cloud.colors_[i]);
  made->ComputeVertexNormals();
  return made;
}

}  // namespace rfsmooth::open3d
