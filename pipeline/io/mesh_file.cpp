#include "rfsmooth/pipeline/io/mesh_file.h"

#include <algorithm>
#include <string>

namespace rfsmooth::pipeline::io {
namespace {

Index corner(double value, const Cloud& cloud, const std::string& what, std::size_t row) {
  if (!(value >= 0 && value < double(cloud.size())))
    throw Failure({ErrorCode::input_unreadable, what + " " + std::to_string(row) + " asks for point " +
                                                    std::to_string(std::int64_t(value)) + "; there are " +
                                                    std::to_string(cloud.size())});
  return Index(value);
}

bool is_corner_list(const Field& field) {
  return field.is_list() && (field.name == "vertex_indices" || field.name == "vertex_index");
}

/// The rows as bytes. A table of text is copied, a binary one is not.
class BinaryRows {
 public:
  BinaryRows(const Table& table, const Context& context) : table_(&table) {
    if (!table.text) return;
    copy_ = table;
    make_binary(copy_, context);
    table_ = &copy_;
  }
  const Table& operator*() const { return *table_; }

 private:
  const Table* table_;
  Table copy_;
};

void store_all(Table& table, Scalar type, double value) {
  char bytes[8];
  store(type, bytes, value);
  table.data.insert(table.data.end(), bytes, bytes + size_of(type));
}

}  // namespace

std::vector<rfs_mesh::Face> faces_of(const Cloud& cloud, const Context& context) {
  std::vector<rfs_mesh::Face> faces;
  const Table* element = cloud.element("face");
  if (element == nullptr || std::none_of(element->fields.begin(), element->fields.end(), is_corner_list))
    return faces;
  const BinaryRows rows(*element, context);
  std::vector<Index> corners;
  for (std::size_t i = 0; i < element->count; ++i) {
    const char* p = (*rows).row(i).data();
    for (const Field& field : (*rows).fields) {
      std::size_t n = field.count;
      if (field.is_list()) {
        n = std::size_t(load(*field.list_count, p));
        p += size_of(*field.list_count);
      }
      if (is_corner_list(field)) {
        corners.clear();
        for (std::size_t k = 0; k < n; ++k)
          corners.push_back(corner(load(field.type, p + k * size_of(field.type)), cloud, "face", i));
        for (std::size_t k = 2; k < corners.size(); ++k)
          faces.push_back({corners[0], corners[k - 1], corners[k]});
        break;
      }
      p += n * size_of(field.type);
    }
  }
  return faces;
}

std::vector<rfs_mesh::Edge> edges_of(const Cloud& cloud, const Context& context) {
  std::vector<rfs_mesh::Edge> edges;
  const Table* element = cloud.element("edge");
  if (element == nullptr) return edges;
  std::vector<std::size_t> ends;
  for (const std::string_view name : {"vertex1", "vertex2"})
    for (std::size_t f = 0; f < element->fields.size(); ++f)
      if (element->fields[f].name == name && element->fields[f].is_plain()) ends.push_back(f);
  if (ends.size() != 2) return edges;
  const std::vector<double> values = gather(*element, ends, context);
  for (std::size_t i = 0; i < element->count; ++i) {
    const Index a = corner(values[2 * i], cloud, "edge", i), b = corner(values[2 * i + 1], cloud, "edge", i);
    if (a != b) edges.push_back({std::min(a, b), std::max(a, b)});
  }
  return edges;
}

Cloud make_mesh_file(const Positions& points, const std::vector<rfs_mesh::Face>& faces,
                     const std::vector<rfs_mesh::Edge>& edges) {
  Cloud cloud = make_cloud(points.empty() ? nullptr : points.front().data(), points.size(), Scalar::float64);
  cloud.format = Format::ply;
  cloud.encoding = Encoding::binary_little_endian;
  if (!faces.empty()) {
    Table table;
    table.name = "face";
    table.count = faces.size();
    Field field;
    field.name = "vertex_indices";
    field.type = Scalar::int32;
    field.list_count = Scalar::uint8;
    table.fields = {field};
    table.start.push_back(0);
    for (const rfs_mesh::Face& face : faces) {
      store_all(table, Scalar::uint8, 3);
      for (const Index v : face) store_all(table, Scalar::int32, v);
      table.start.push_back(table.data.size());
    }
    cloud.elements.push_back(std::move(table));
  }
  if (!edges.empty()) {
    Table table;
    table.name = "edge";
    table.count = edges.size();
    for (const char* name : {"vertex1", "vertex2"}) {
      Field field;
      field.name = name;
      field.type = Scalar::int32;
      table.fields.push_back(field);
    }
    for (const rfs_mesh::Edge& edge : edges)
      for (const Index v : edge) store_all(table, Scalar::int32, v);
    cloud.elements.push_back(std::move(table));
  }
  return cloud;
}

}  // namespace rfsmooth::pipeline::io
