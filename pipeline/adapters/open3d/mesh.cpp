#include <limits>
#include <stdexcept>

#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>

#include <rfsmooth/open3d/mesh.h>

#include "base/parallel.h"
#include "pipeline/row_order.h"
#include "rfs_mesh/measure.h"
#include "rfs_mesh/normals/orient.h"

namespace rfsmooth::open3d {

using ::open3d::geometry::PointCloud;
using ::open3d::geometry::TriangleMesh;

namespace {

std::shared_ptr<TriangleMesh> make(const PointCloud& cloud, const ConnectOptions& options,
                                   const Context& context) {
  const std::size_t n = cloud.points_.size();
  const rfs_mesh::WorkingCloud working = value_or_throw(
      rfs_mesh::make_working_cloud(n == 0 ? nullptr : cloud.points_.front().data(), n, context));
  Connection connection = value_or_throw(rfsmooth::connect(working.points, options, context));
  Positions found;  // n: normals
  for (std::size_t p = 0; p < connection.surfaces.size(); ++p) {
    found.push_back(connection.surfaces[p].normal);
    connection.mesh.positions[p] =
        connection.surfaces[p].shadow;  // the noise of an edge says nothing of sides
  }
  rfs_mesh::orient(connection.mesh, connection.tree, connection.bridges, {}, found, context);

  const auto [row, rank] = pipeline::row_order(working);
  Mesh mesh;
  Positions normals;
  for (const std::size_t i : row) {
    mesh.positions.push_back(cloud.points_[i]);
    normals.push_back(found[working.of_input[i]]);
  }
  mesh.faces = connection.mesh.faces;
  for (auto& face : mesh.faces)
    for (Index& corner : face) corner = rank[corner];
  auto made = to_triangle_mesh(mesh, normals);
  if (cloud.HasColors())
    for (const std::size_t i : row) made->vertex_colors_.push_back(cloud.colors_[i]);
  return made;
}

}  // namespace

std::shared_ptr<TriangleMesh> to_triangle_mesh(const Mesh& mesh, const Positions& normals) {
  if (mesh.positions.size() > std::size_t(std::numeric_limits<int>::max()))
    throw std::length_error("Open3D counts vertices by int: a mesh has at most 2^31 - 1");
  const bool turn = !normals.empty();
  if (turn && normals.size() != mesh.positions.size())
    throw std::invalid_argument("the normals are not one per vertex");
  auto made = std::make_shared<TriangleMesh>();
  made->vertices_ = mesh.positions;
  made->vertex_normals_ = normals;
  made->triangles_.reserve(mesh.faces.size());
  for (const Face& f : mesh.faces) {
    const bool over =
        turn &&
        rfs_mesh::face_cross(mesh.positions, f).dot(normals[f[0]] + normals[f[1]] + normals[f[2]]) < 0;
    made->triangles_.emplace_back(int(f[0]), int(f[over ? 2 : 1]), int(f[over ? 1 : 2]));
  }
  return made;
}

Result<std::shared_ptr<TriangleMesh>> rough_mesh(const PointCloud& cloud, const ConnectOptions& options,
                                                 const Context& context) {
  return guarded([&] {
    std::shared_ptr<TriangleMesh> made;
    in_arena(context, [&] { made = make(cloud, options, context); });
    return made;
  });
}

}  // namespace rfsmooth::open3d
