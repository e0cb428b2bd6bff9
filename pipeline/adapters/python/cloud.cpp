#include "pipeline/adapters/python/cloud.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "base/fail.h"
#include "pipeline/adapters/python/released.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/io/formats/las/las_scale.h"
#include "pipeline/io/io.h"
#include "pipeline/io/mesh_file.h"

namespace rfsmooth::python {

namespace nb = nanobind;
namespace io = pipeline::io;

namespace {

using Rows = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Triples = nb::ndarray<const std::uint32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Coordinates = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using FieldText = std::tuple<std::string, std::string, std::size_t>;  ///< name, numpy's type, values per row

template <class T, int... Width>
using Array = nb::ndarray<nb::numpy, T, nb::shape<-1, Width...>>;

/// A numpy array that owns what `values` held, in rows of that width.
template <class T, int... Width, class Values>
Array<T, Width...> array_of(Values values) {
  auto* held = new Values(std::move(values));
  nb::capsule owner(held, [](void* p) noexcept { delete static_cast<Values*>(p); });
  const std::size_t rows = held->size() * sizeof(*held->data()) / (sizeof(T) * (1 * ... * Width));
  return Array<T, Width...>(reinterpret_cast<T*>(held->data()), {rows, std::size_t(Width)...}, owner);
}

io::Scalar scalar_of(const std::string& name) {
  for (const io::Scalar type : io::kScalars)
    if (io::name_of(type) == name) return type;
  throw std::invalid_argument("no file holds fields of type " + name);
}

io::Table table_of(const std::vector<FieldText>& fields, const Rows& rows, std::size_t count) {
  io::Table table;
  table.name = "vertex";
  table.count = count;
  for (const auto& [name, type, values] : fields) table.fields.push_back({name, scalar_of(type), values});
  const std::size_t size = table.row_size();
  if (size == 0 ? rows.size() != 0 : rows.size() % size != 0 || rows.size() / size != count)
    throw std::invalid_argument("the rows have another size");
  table.data.resize(rows.size());
  if (rows.size() > 0) std::memcpy(table.data.data(), rows.data(), rows.size());
  return table;
}

/// The fields of a fixed size, in file order.
std::vector<std::size_t> fixed_fields(const io::Table& table) {
  std::vector<std::size_t> which;
  for (std::size_t f = 0; f < table.fields.size(); ++f)
    if (!table.fields[f].is_list()) which.push_back(f);
  return which;
}

std::vector<FieldText> fields_of(const io::Cloud& cloud) {
  std::vector<FieldText> fields;
  for (const std::size_t f : fixed_fields(cloud.points())) {
    const io::Field& field = cloud.points().fields[f];
    fields.emplace_back(field.name, io::name_of(field.type), field.count);
  }
  return fields;
}

/// Which of those fields are the coordinates.
std::tuple<std::size_t, std::size_t, std::size_t> coordinate_fields(const io::Cloud& cloud) {
  const std::vector<std::size_t> fixed = fixed_fields(cloud.points());
  const auto place = [&](std::size_t field) {
    return std::size_t(std::find(fixed.begin(), fixed.end(), field) - fixed.begin());
  };
  return {place(cloud.xyz[0]), place(cloud.xyz[1]), place(cloud.xyz[2])};
}

/// A copy with those fields only, as bytes.
io::Table fixed_part(io::Table table) {
  if (table.has_lists()) io::project(table, fixed_fields(table), {});
  io::make_binary(table, {});
  return table;
}

/// Those fields of the points as bytes, row after row.
Array<std::uint8_t> rows_of(const io::Cloud& cloud) {
  return array_of<std::uint8_t>(fixed_part(cloud.points()).data);
}

io::Cloud cloud_of(const std::vector<FieldText>& fields, const Rows& rows, std::size_t count,
                   const std::tuple<std::size_t, std::size_t, std::size_t>& xyz) {
  io::Cloud cloud;
  cloud.width = count;
  cloud.xyz = {std::get<0>(xyz), std::get<1>(xyz), std::get<2>(xyz)};
  cloud.elements.push_back(table_of(fields, rows, count));
  for (const std::size_t f : cloud.xyz)
    if (f >= fields.size()) throw std::invalid_argument("there is no such field");
  return cloud;
}

bool same_fields(const io::Table& one, const io::Table& other) {
  if (one.fields.size() != other.fields.size()) return false;
  for (std::size_t f = 0; f < one.fields.size(); ++f) {
    const io::Field &a = one.fields[f], &b = other.fields[f];
    if (a.name != b.name || a.type != b.type || a.count != b.count || a.is_list() || b.is_list())
      return false;
  }
  return true;
}

/// Whether two tables, whose fields up to `field` are the same, have the same bytes in it.
bool same_column(const io::Table& one, const io::Table& other, std::size_t field) {
  const std::size_t begin = one.offset_of(field), size = one.fields[field].bytes();
  for (std::size_t i = 0; i < one.count; ++i)
    if (one.row(i).substr(begin, size) != other.row(i).substr(begin, size)) return false;
  return true;
}

/// The values to write into a column of text. \param before what numpy was given: the file's values, rounded
/// to the type of the column. \param given what numpy gave back. \param now the file's values with all digits
/// of the text; they stay where `given` is the same as `before`.
std::vector<double> changed(const std::vector<double>& before, const std::vector<double>& given,
                            std::vector<double> now) {
  for (std::size_t i = 0; i < now.size(); ++i)
    if (given[i] != before[i] && !(std::isnan(given[i]) && std::isnan(before[i]))) now[i] = given[i];
  return now;
}

/// Puts rows in the place of the file's: fields of the same name (the first `known` of `fields`, in file
/// order) get their values in place, the others come behind. What is equal keeps its bytes or text.
void put_rows(io::Cloud& cloud, const std::vector<FieldText>& fields, const Rows& rows, std::size_t known) {
  io::Table& table = cloud.points();
  io::Table given = table_of(fields, rows, table.count);
  const std::vector<std::size_t> fixed = fixed_fields(table);
  if (known != fixed.size()) throw std::invalid_argument("the fields are not the file's");
  if (!table.text && same_fields(table, given)) {
    table.data = std::move(given.data);
    return;
  }
  const io::Table before = fixed_part(table);
  for (std::size_t f = 0; f < given.fields.size(); ++f) {
    if (f < known && same_column(before, given, f)) continue;
    if (!given.fields[f].is_plain())
      fail(ErrorCode::usage,
           "field '{}': several values a row can be changed in binary files only, and not be added",
           given.fields[f].name);
    std::vector<double> values = io::gather(given, {f}, {});
    if (f < known) {
      values = changed(io::gather(before, {f}, {}), values, io::gather(table, {fixed[f]}, {}));
      io::scatter(table, {fixed[f]}, values.data(), {});
    } else {
      io::append_field(table, given.fields[f], values.data(), {});
    }
  }
}

/// n x 3 coordinates in world units, each written in the file's own type; of LAS in its scale, which is
/// refined first where it is coarser than `scale`.
void put_positions(io::Cloud& cloud, const Coordinates& xyz, const std::optional<double>& scale) {
  if (xyz.shape(0) != cloud.size()) throw std::invalid_argument("not one position for each point");
  released(nb::none(), 0, {}, [&](const Context& context, cli::Console&) {
    if (scale && cloud.format == io::Format::las) io::refine_scale(cloud, *scale, xyz.data(), context);
    io::set_positions(cloud, xyz.data(), context);
  });
}

/// The kind of each edge, where the edges have one.
std::optional<Array<std::uint8_t>> edge_kinds(const io::Cloud& cloud) {
  const io::Table* const edges = cloud.element("edge");
  if (edges == nullptr || edges->fields.size() < 3) return std::nullopt;
  const std::vector<double> values = io::gather(*edges, {2}, {});
  return array_of<std::uint8_t>(std::vector<std::uint8_t>(values.begin(), values.end()));
}

/// Triangles whose corners are points there are.
void put_faces(io::Cloud& cloud, const Triples& triples) {
  std::vector<Face> faces(triples.shape(0));
  for (std::size_t i = 0; i < faces.size(); ++i) std::copy_n(triples.data() + 3 * i, 3, faces[i].begin());
  io::set_faces(cloud, faces);
}

io::Cloud read_file(const std::string& path) {
  io::Cloud cloud;
  released(nb::none(), 0, {},
           [&](const Context& context, cli::Console&) { cloud = cli::load_cloud(path, context); });
  return cloud;
}

void write_file(const io::Cloud& cloud, const std::string& path, const std::optional<std::string>& format,
                const std::optional<std::string>& encoding, bool force, bool drop_unsupported) {
  io::WriteOptions options;
  options.force = force;
  options.drop_unsupported = drop_unsupported;
  if (format && !(options.format = io::format_by_name(*format)))
    fail(ErrorCode::usage, "`format` is '{}'; no file is written so", *format);
  if (encoding && !(options.encoding = io::encoding_by_name(*encoding)))
    fail(ErrorCode::usage, "`encoding` is '{}'; no file is written so", *encoding);
  released(nb::none(), 0, {}, [&](const Context& context, cli::Console&) {
    value_or_throw(io::write_cloud(cloud, path, options, context));
  });
}

}  // namespace

void bind_cloud(nb::module_& module) {
  nb::class_<io::Cloud>(module, "Cloud")
      .def(nb::new_(&cloud_of), nb::arg("fields"), nb::arg("rows"), nb::arg("count"), nb::arg("xyz"))
      .def("__copy__", [](const io::Cloud& cloud) { return io::Cloud(cloud); })
      .def_prop_ro("fields", &fields_of)
      .def_prop_ro("xyz", &coordinate_fields)
      .def_prop_ro("format", [](const io::Cloud& cloud) { return std::string(io::name_of(cloud.format)); })
      .def_prop_ro("encoding",
                   [](const io::Cloud& cloud) { return std::string(io::name_of(cloud.encoding)); })
      .def_prop_ro("extent", [](const io::Cloud& c) { return std::pair(c.width, c.height); })
      .def_prop_rw(
          "viewpoint", [](const io::Cloud& cloud) { return cloud.viewpoint; },
          [](io::Cloud& cloud, const std::string& viewpoint) { cloud.viewpoint = viewpoint; })
      .def("__len__", &io::Cloud::size)
      .def("rows", &rows_of)
      .def("put_rows", &put_rows, nb::arg("fields"), nb::arg("rows"), nb::arg("known"))
      .def("positions", [](const io::Cloud& cloud) { return array_of<double, 3>(io::positions(cloud)); })
      .def("put_positions", &put_positions, nb::arg("xyz"), nb::arg("scale").none())
      .def("faces", [](const io::Cloud& cloud) { return array_of<std::uint32_t, 3>(io::faces_of(cloud)); })
      .def("put_faces", &put_faces)
      .def("edges", [](const io::Cloud& cloud) { return array_of<std::uint32_t, 2>(io::edges_of(cloud)); })
      .def("edge_kinds", &edge_kinds);
  module.def("read_file", &read_file);
  module.def("write_file", &write_file);
}

}  // namespace rfsmooth::python
