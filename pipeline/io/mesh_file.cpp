#include "pipeline/io/mesh_file.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/fail.h"

namespace rfsmooth::pipeline::io {
namespace {

Index point(double value, const Cloud& cloud, const char* what, std::size_t row) {
  if (!(value >= 0 && value < double(cloud.size())))
    fail(ErrorCode::input_unreadable, "{} {}: expected points below {}, found {}", what, row, cloud.size(),
         value);
  return Index(value);
}

// Replaces the element of that name, or appends it.
void put(Cloud& cloud, Table table) {
  for (Table& present : cloud.elements)
    if (present.name == table.name) {
      present = std::move(table);
      return;
    }
  cloud.elements.push_back(std::move(table));
}

void append(Bytes& data, std::int32_t value) {
  const auto* p = reinterpret_cast<const char*>(&value);
  data.insert(data.end(), p, p + sizeof value);
}

}  // namespace

std::optional<std::size_t> polygon_field(const Table& table) {
  for (std::size_t f = 0; f < table.fields.size(); ++f)
    if (table.fields[f].is_list() &&
        (table.fields[f].name == "vertex_indices" || table.fields[f].name == "vertex_index"))
      return f;
  return std::nullopt;
}

std::vector<Face> faces_of(const Cloud& cloud, const Context& context) {
  std::vector<Face> faces;
  const Table* table = cloud.element("face");
  const auto field = table == nullptr ? std::nullopt : polygon_field(*table);
  if (!field) return faces;
  const Lists polygons = gather_lists(*table, *field, context);
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < table->count; ++i) {
    std::vector<Index> corners;
    for (std::uint64_t k = polygons.start[i]; k < polygons.start[i + 1]; ++k)
      corners.push_back(point(polygons.values[k], cloud, "face", i));
    if (corners.size() < 3) ++left_out;
    for (std::size_t k = 2; k < corners.size(); ++k) {
      const Face face{corners[0], corners[k - 1], corners[k]};
      if (face[0] == face[1] || face[1] == face[2] || face[0] == face[2])
        ++left_out;
      else
        faces.push_back(face);
    }
  }
  if (left_out > 0)
    context.warn(fmt::format("left out of the work: {}", counted(left_out, "degenerate face")));
  return faces;
}

std::vector<Edge> edges_of(const Cloud& cloud, const Context& context) {
  std::vector<Edge> edges;
  const Table* table = cloud.element("edge");
  if (table == nullptr) return edges;
  std::vector<std::size_t> ends;
  for (const std::string_view name : {"vertex1", "vertex2"})
    for (std::size_t f = 0; f < table->fields.size(); ++f)
      if (table->fields[f].name == name && table->fields[f].is_plain()) ends.push_back(f);
  if (ends.size() != 2) return edges;
  const std::vector<double> values = gather(*table, ends, context);
  for (std::size_t i = 0; i < table->count; ++i) {
    const Index a = point(values[2 * i], cloud, "edge", i), b = point(values[2 * i + 1], cloud, "edge", i);
    if (a != b) edges.push_back({std::min(a, b), std::max(a, b)});
  }
  return edges;
}

void set_faces(Cloud& cloud, const std::vector<Face>& faces) {
  Table table;
  table.name = "face";
  table.fields.push_back({"vertex_indices", Scalar::int32, 1, Scalar::uint8});
  table.count = faces.size();
  table.data.reserve(13 * faces.size());
  table.start.push_back(0);
  for (const Face& face : faces) {
    table.data.push_back(3);
    for (const Index corner : face) append(table.data, std::int32_t(corner));
    table.start.push_back(table.data.size());
  }
  put(cloud, std::move(table));
}

void set_edges(Cloud& cloud, const std::vector<Edge>& edges, const std::vector<std::uint8_t>& kind) {
  Table table;
  table.name = "edge";
  table.fields = {{"vertex1", Scalar::int32}, {"vertex2", Scalar::int32}};
  if (!kind.empty()) table.fields.push_back({"kind", Scalar::uint8});
  table.count = edges.size();
  table.data.reserve(9 * edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const Index end : edges[e]) append(table.data, std::int32_t(end));
    if (!kind.empty()) table.data.push_back(static_cast<char>(kind.at(e)));
  }
  put(cloud, std::move(table));
}

Cloud make_mesh_file(const Positions& points, const std::vector<Face>& faces, const std::vector<Edge>& edges,
                     const std::vector<std::uint8_t>& kind) {
  Cloud cloud = make_cloud(points.empty() ? nullptr : points.front().data(), points.size(), Scalar::float64);
  if (!faces.empty()) set_faces(cloud, faces);
  if (!edges.empty()) set_edges(cloud, edges, kind);
  return cloud;
}

}  // namespace rfsmooth::pipeline::io
