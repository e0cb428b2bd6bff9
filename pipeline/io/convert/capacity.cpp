#include "pipeline/io/convert/capacity.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "base/fail.h"
#include "pipeline/io/formats/las/las_pack.h"
#include "pipeline/io/formats/off.h"
#include "pipeline/io/mesh_file.h"

namespace rfsmooth::pipeline::io {

namespace {

using Elements = Capacity::Elements;
using Grid = Capacity::Grid;

bool contains(const std::vector<std::size_t>& fields, std::size_t field) {
  return std::find(fields.begin(), fields.end(), field) != fields.end();
}

std::vector<std::size_t> nothing_first(const Cloud&) {
  return {};
}

std::vector<std::size_t> coordinates_first(const Cloud& cloud) {
  return {cloud.xyz.begin(), cloud.xyz.end()};
}

bool has_ply_type(const Cloud& cloud, std::size_t field, const Context&) {
  return !cloud.points().fields[field].is_wide();
}

/// PCD has arrays, whose length is the same in every row.
bool is_scalar_or_array(const Cloud& cloud, std::size_t field, const Context& context) {
  return !cloud.points().fields[field].is_list() || constant_length(cloud.points(), field, context);
}

bool is_one_value(const Cloud& cloud, std::size_t field, const Context&) {
  return cloud.points().fields[field].is_plain();
}

bool is_known_to_off(const Cloud& cloud, std::size_t field, const Context&) {
  return contains(off_fields(cloud), field);
}

bool is_known_to_las(const Cloud& cloud, std::size_t field, const Context&) {
  return is_las_field(cloud.points().fields[field]);
}

constexpr Encoding kText = Encoding::ascii, kBinary = Encoding::binary_little_endian,
                   kBigEndian = Encoding::binary_big_endian, kCompressed = Encoding::binary_compressed;

const std::vector<Capacity>& capacities() {
  // clang-format off
  static const std::vector<Capacity> kCapacities = {
      // format      encodings                     not finite  grid          elements            first              field
      {Format::ply, {kBinary, kText, kBigEndian},  true,       Grid::notes,  Elements::all,      nothing_first,     has_ply_type},
      {Format::pcd, {kBinary, kText, kCompressed}, true,       Grid::header, Elements::none,     nothing_first,     is_scalar_or_array},
      {Format::xyz, {kText},                       true,       Grid::none,   Elements::none,     coordinates_first, is_one_value},
      {Format::off, {kText},                       true,       Grid::none,   Elements::polygons, off_fields,        is_known_to_off},
      {Format::las, {kBinary},                     false,      Grid::notes,  Elements::none,     nothing_first,     is_known_to_las}};
  // clang-format on
  return kCapacities;
}

}  // namespace

const Capacity& capacity_of(Format format) {
  for (const Capacity& capacity : capacities())
    if (capacity.format == format) return capacity;
  throw std::invalid_argument("capacity_of: not a Format");
}

Encoding target_encoding(const Cloud& cloud, Format format, std::optional<Encoding> wanted) {
  const std::vector<Encoding>& known = capacity_of(format).encodings;
  const Encoding encoding = wanted.value_or(cloud.encoding);
  if (std::find(known.begin(), known.end(), encoding) != known.end()) return encoding;
  if (wanted) fail(ErrorCode::usage, "{} has no encoding {}", name_of(format), name_of(encoding));
  return known.front();
}

bool is_padding(const Field& field) {
  return field.name == "_";
}

bool is_coordinate(const Cloud& cloud, std::size_t field) {
  return std::find(cloud.xyz.begin(), cloud.xyz.end(), field) != cloud.xyz.end();
}

std::vector<std::size_t> kept_fields(const Cloud& cloud, Format format, const Context& context) {
  const Capacity& capacity = capacity_of(format);
  std::vector<std::size_t> kept = capacity.first(cloud);
  for (std::size_t f = 0; f < cloud.points().fields.size(); ++f)
    if (!is_padding(cloud.points().fields[f]) && !contains(kept, f) &&
        (is_coordinate(cloud, f) || capacity.field(cloud, f, context)))
      kept.push_back(f);
  return kept;
}

std::optional<std::vector<std::size_t>> kept_of_element(const Table& element, Format from, Format to) {
  const Elements elements = capacity_of(to).elements;
  if (elements == Elements::none) return std::nullopt;
  if (elements == Elements::polygons) {
    const auto corners = polygon_field(element);
    if (element.name != "face" || !corners) return std::nullopt;
    if (from != to) return std::vector<std::size_t>{*corners};
  }
  std::vector<std::size_t> all(element.fields.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

std::optional<std::size_t> constant_length(const Table& table, std::size_t field, const Context& context) {
  const std::vector<std::size_t> lengths = list_lengths(table, field, context);
  if (lengths.empty() || lengths.front() == 0) return std::nullopt;
  const bool same =
      std::count(lengths.begin(), lengths.end(), lengths.front()) == std::ptrdiff_t(lengths.size());
  return same ? std::optional(lengths.front()) : std::nullopt;
}

}  // namespace rfsmooth::pipeline::io
