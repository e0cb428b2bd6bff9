#include "pipeline/cli/files/surface_file.h"

#include "pipeline/io/convert/convert.h"
#include "pipeline/io/formats/las/las_plain.h"
#include "pipeline/io/mesh_file.h"
#include "pipeline/io/point_fields.h"
#include "rfs_mesh/measure.h"

namespace rfsmooth::cli {

namespace io = pipeline::io;

namespace {

void unpack_colours(io::Cloud& cloud, const Context& context) {
  if (io::find_field(cloud, "red")) return;
  for (const char* name : {"rgb", "rgba"}) {
    const auto field = io::find_plain_field(cloud, name);
    if (!field || io::size_of(cloud.points().fields[*field].type) != 4) continue;
    io::make_binary(cloud.points(), context);
    const std::vector<std::uint32_t> packed = io::packed_colors(cloud, *field, context);
    std::vector<double> part(packed.size());
    const auto add = [&](const char* colour, int shift) {
      for (std::size_t i = 0; i < part.size(); ++i) part[i] = (packed[i] >> shift) & 255;
      io::set_field(cloud, colour, io::Scalar::uint8, part, context);
    };
    add("red", 16);
    add("green", 8);
    add("blue", 0);
    if (std::string_view(name) == "rgba") add("alpha", 24);
    return;
  }
}

void set_normals(io::Cloud& cloud, const Mesh& mesh, const Context& context) {
  if (!io::has_normals(cloud)) return;
  const io::NormalNames& names = io::find_field(cloud, io::kPlyNormal[0]) ? io::kPlyNormal : io::kPcdNormal;
  const Positions normals = rfs_mesh::vertex_normals(mesh, context);
  std::vector<double> part(normals.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = normals[i][Eigen::Index(axis)];
    io::set_field(cloud, names[axis], io::Scalar::float32, part, context);
  }
}

}  // namespace

std::vector<std::string> lost_in_surface(const io::Cloud& cloud, io::Format format, io::Encoding encoding,
                                         const Context& context) {
  io::Cloud fields = io::make_cloud(nullptr, 0);
  const bool las = cloud.format == io::Format::las;
  if (!las) fields.format = cloud.format;
  fields.xyz = cloud.xyz;
  fields.points().fields = las ? io::plain_fields(cloud) : cloud.points().fields;
  return io::what_is_lost(fields, format, encoding, context);
}

io::Cloud surface_file(io::Cloud cloud, const Reconstruction& made, const Context& context) {
  if (cloud.format != io::Format::ply) cloud = io::convert(cloud, io::Format::ply, context);
  io::Cloud out;
  out.encoding =
      cloud.encoding == io::Encoding::binary_compressed ? io::Encoding::binary_little_endian : cloud.encoding;
  out.elements.push_back(std::move(cloud.points()));
  out.points().name = "vertex";
  out.xyz = cloud.xyz;
  out.width = out.points().count;
  io::select_points(out, made.row, context);
  std::vector<double> xyz;
  xyz.reserve(3 * made.mesh.positions.size());
  for (const Eigen::Vector3d& p : made.mesh.positions) xyz.insert(xyz.end(), p.data(), p.data() + 3);
  io::set_positions(out, xyz.data(), context);
  unpack_colours(out, context);
  set_normals(out, made.mesh, context);
  io::set_faces(out, made.mesh.faces);
  return out;
}

}  // namespace rfsmooth::cli
