#include "pipeline/cli/files/file_mesh.h"

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/io/convert/capacity.h"
#include "pipeline/io/mesh_file.h"

namespace rfsmooth::cli {

namespace io = pipeline::io;
using Eigen::Vector3d;

FileMesh file_mesh(const io::Cloud& cloud, const std::string& name, const Context& context,
                   bool own_heights) {
  const std::vector<Face> faces = io::faces_of(cloud, context);
  if (faces.empty())
    fail(ErrorCode::input_unreadable, "has no faces; expected a mesh (for clouds use: rfsmooth denoise)");
  FileMesh out;
  out.xyz = io::positions(cloud, context);
  out.of_row.assign(cloud.size(), kNone);
  Positions& points = out.mesh.positions;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3d p(&out.xyz[3 * i]);
    if (!p.allFinite()) continue;
    out.of_row[i] = Index(points.size());
    points.push_back(p);
  }
  if (points.empty()) fail(ErrorCode::no_usable_points, "no vertex is finite");
  out.origin = points.front();
  if (own_heights) out.origin.z() = 0;
  for (Vector3d& p : points) p -= out.origin;
  std::size_t left_out = 0;
  for (const Face& face : faces) {
    const Face f = {out.of_row[face[0]], out.of_row[face[1]], out.of_row[face[2]]};
    const bool whole = f[0] != kNone && f[1] != kNone && f[2] != kNone;
    left_out += !whole;
    if (whole && f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) out.mesh.faces.push_back(f);
  }
  if (left_out > 0)
    context.warn(fmt::format("{}: left out of the work: {} with a corner that is not finite", name,
                             counted(left_out, "face")));
  out.before = points;
  rfsmooth::rebuild_adjacency(out.mesh, context);
  return out;
}

std::vector<double> FileMesh::moved_rows(bool& any) const {
  std::vector<double> rows = xyz;
  any = false;
  for (std::size_t i = 0; i < of_row.size(); ++i) {
    if (of_row[i] == kNone) continue;
    const Vector3d move = mesh.positions[of_row[i]] - before[of_row[i]];
    for (int axis = 0; axis < 3; ++axis)
      if (move[axis] != 0) {
        rows[3 * i + std::size_t(axis)] += move[axis];
        any = true;
      }
  }
  return rows;
}

std::vector<std::string> lost_in_refined(const io::Cloud& cloud) {
  std::vector<std::string> lost;
  for (std::size_t f = 0; f < cloud.points().fields.size(); ++f)
    if (!io::is_coordinate(cloud, f))
      lost.push_back(fmt::format("field '{}'", cloud.points().fields[f].name));
  for (std::size_t e = 0; e < cloud.elements.size(); ++e) {
    const io::Table& table = cloud.elements[e];
    if (e == cloud.vertex || table.count == 0) continue;
    const auto corners = io::polygon_field(table);
    if (!corners) lost.push_back(fmt::format("element '{}'", table.name));
    for (std::size_t f = 0; corners && f < table.fields.size(); ++f)
      if (f != *corners) lost.push_back(fmt::format("field '{}' of the faces", table.fields[f].name));
  }
  if (!cloud.notes.empty()) lost.push_back(counted(cloud.notes.size(), "comment"));
  return lost;
}

void put_refined(io::Cloud& cloud, const FileMesh& file, const std::vector<double>& rows, const Mesh& fine) {
  const std::size_t given = file.before.size(), n = file.of_row.size();
  std::vector<std::size_t> row(fine.positions.size());
  for (std::size_t i = 0; i < n; ++i)
    if (file.of_row[i] != kNone) row[file.of_row[i]] = i;
  std::vector<double> all = rows;
  for (std::size_t v = 0; v < given; ++v)  // taking off pimples moves given vertices too
    for (std::size_t axis = 0; axis < 3; ++axis)
      all[3 * row[v] + axis] +=
          fine.positions[v][Eigen::Index(axis)] - file.mesh.positions[v][Eigen::Index(axis)];
  for (std::size_t v = given; v < fine.positions.size(); ++v) {
    row[v] = all.size() / 3;
    for (const double c : Vector3d(fine.positions[v] + file.origin)) all.push_back(c);
  }
  std::vector<Face> faces = fine.faces;
  for (Face& face : faces)
    for (Index& v : face) v = Index(row[v]);
  io::Cloud refined = io::make_cloud(all.data(), all.size() / 3, cloud.points().fields[cloud.xyz[0]].type);
  io::set_faces(refined, faces);
  refined.encoding = cloud.encoding;
  cloud = std::move(refined);
}

}  // namespace rfsmooth::cli
