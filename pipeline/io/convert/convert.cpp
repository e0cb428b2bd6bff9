#include "pipeline/io/convert/convert.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/io/convert/capacity.h"
#include "pipeline/io/convert/notes.h"
#include "pipeline/io/formats/las/las_pack.h"
#include "pipeline/io/formats/las/las_plain.h"
#include "pipeline/io/formats/off.h"

namespace rfsmooth::pipeline::io {
namespace {

using Losses = std::vector<std::string>;

// Whether the digits of the coordinates count, or they will get others.
enum class Digits { of_all, of_others };

// OFF's columns have no names: those of a file that OFF has no word for stay, one that was added is lost.
bool is_unnamed(const Field& f) {
  return f.name.rfind("column_", 0) == 0;
}

// PLY has no arrays. A type that it does not have stays where it came from a PLY file, as its spelling tells.
bool has_ply_types(const Table& points) {
  return std::all_of(points.fields.begin(), points.fields.end(),
                     [](const Field& f) { return f.count == 1 && (!f.is_wide() || !f.spelling.empty()); });
}

bool float_digits_lost(const Table& table, std::size_t field, const Context& context) {
  if (!table.text || table.fields[field].type != Scalar::float32 || !table.fields[field].is_plain())
    return false;
  // Text says what it says; only bytes have a width.
  return !text_fits_float32(table, {field}, context);
}

bool has_ragged_values(const Table& table, const Context& context) {
  if (!table.ragged) return false;
  const std::vector<std::size_t> lengths = list_lengths(table, 0, context);
  for (std::size_t i = 0; i < table.count; ++i) {
    std::string_view row = table.row(i);
    for (std::size_t k = 0; k <= lengths[i]; ++k) next_word(row);
    if (!next_word(row).empty()) return true;
  }
  return false;
}

void add_lost_fields(const Cloud& cloud, Format format, Encoding encoding, Digits digits,
                     const Context& context, Losses& lost) {
  const Table& points = cloud.points();
  const bool as_is = is_writable_as_is(cloud, format);
  for (std::size_t f = 0; f < points.fields.size(); ++f) {
    const Field& field = points.fields[f];
    const bool kept = (as_is && (format != Format::off || is_unnamed(field))) || is_padding(field) ||
                      capacity_of(format).field(cloud, f, context);
    if (!kept)
      lost.push_back(fmt::format("field '{}'", field.name));
    else if (encoding != Encoding::ascii &&
             !((format == Format::las || digits == Digits::of_others) && is_coordinate(cloud, f)) &&
             float_digits_lost(points, f, context))
      lost.push_back(fmt::format("all digits of field '{}' (float32)", field.name));
  }
}

void add_lost_elements(const Cloud& cloud, Format format, const Context& context, Losses& lost) {
  for (std::size_t e = 0; e < cloud.elements.size(); ++e) {
    const Table& table = cloud.elements[e];
    if (e == cloud.vertex || table.count == 0) continue;
    const auto kept = kept_of_element(table, cloud.format, format);
    if (!kept) {
      lost.push_back(fmt::format("element '{}'", table.name));
      continue;
    }
    for (std::size_t f = 0; f < table.fields.size(); ++f)
      if (std::find(kept->begin(), kept->end(), f) == kept->end())
        lost.push_back(fmt::format("field '{}' of the faces", table.fields[f].name));
    if (has_ragged_values(table, context)) lost.push_back("colours of the faces");
  }
}

// Coordinates cannot be left out: those of a type that PLY does not have become doubles.
void widen_coordinates(Table& table, const Context& context) {
  const bool text = table.text;
  for (Field& field : table.fields) {
    if (!field.is_wide()) continue;
    make_text(table, context);
    field.type = Scalar::float64;
  }
  if (!text) make_binary(table, context);
}

// Arrays of a fixed length become lists: each row gets its count in front.
void arrays_to_lists(Table& table, const Context& context) {
  for (std::size_t f = 0; f < table.fields.size(); ++f) {
    Field& field = table.fields[f];
    if (field.count == 1) continue;
    const Scalar count_type = field.count < 256 ? Scalar::uint8 : Scalar::uint32;
    insert_list_counts(table, f, count_type, context);
  }
}

void lists_to_arrays(Table& table, const Context& context) {
  for (std::size_t f = 0; f < table.fields.size(); ++f)
    if (table.fields[f].is_list())
      remove_list_counts(table, f, constant_length(table, f, context).value(), context);
}

// Gives the fields types that the format has.
void fit_types(Table& points, Format format, const Context& context) {
  if (format == Format::ply) {
    widen_coordinates(points, context);
    arrays_to_lists(points, context);
  }
  if (format == Format::pcd) lists_to_arrays(points, context);
}

// OFF's faces have no type for their counts; PLY's usual one is uchar.
void narrow_face_counts(Table& faces, const Context& context) {
  if (!faces.text || faces.fields.empty() || !faces.fields[0].is_list()) return;
  const std::vector<std::size_t> lengths = list_lengths(faces, 0, context);
  const bool fit = std::none_of(lengths.begin(), lengths.end(), [](std::size_t n) { return n > 255; });
  if (fit) faces.fields[0].list_count = Scalar::uint8;
}

// The elements beside the points, as far as they go along.
void add_kept_elements(const Cloud& cloud, Format format, const Context& context, Cloud& out) {
  for (std::size_t e = 0; e < cloud.elements.size(); ++e) {
    if (e == cloud.vertex) continue;
    const auto kept = kept_of_element(cloud.elements[e], cloud.format, format);
    if (!kept) continue;
    Table table = cloud.elements[e];
    if (format != cloud.format) project(table, *kept, context);  // without ragged values, too
    if (cloud.format == Format::off) narrow_face_counts(table, context);
    out.elements.push_back(std::move(table));
  }
}

// What writing the cloud in this way would lose.
Losses losses_of(const Cloud& cloud, Format format, Encoding encoding, Digits digits,
                 const Context& context) {
  Losses lost;
  if (cloud.format == Format::las && format != Format::las) {
    Cloud fields = make_cloud(nullptr, 0);
    fields.points().fields = plain_fields(cloud);
    lost = losses_of(fields, format, encoding, digits, context);
    const Losses more = las_losses(cloud);
    lost.insert(lost.end(), more.begin(), more.end());
    return lost;
  }
  add_lost_fields(cloud, format, encoding, digits, context, lost);
  if (format == cloud.format) return lost;
  add_lost_elements(cloud, format, context, lost);
  const Capacity& capacity = capacity_of(format);
  if (!capacity.not_finite)
    if (const std::size_t n = cloud.size() - finite_rows(positions(cloud, context), context); n > 0)
      lost.push_back(fmt::format("{} not finite", counted(n, "point")));
  if (capacity.grid == Capacity::Grid::none) {
    if (cloud.organised()) lost.push_back(fmt::format("the grid of {} x {}", cloud.width, cloud.height));
    if (cloud.viewpoint != kNoViewpoint) lost.push_back("the viewpoint");
  }
  return lost;
}

// Only XYZ may call x, y and z otherwise.
void name_coordinates(Table& points, const std::array<std::size_t, 3>& xyz) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (std::string& name = points.fields[xyz[axis]].name; name != std::string(1, char('X' + axis)))
      name = char('x' + axis);
}

// The points, as far as they go along; sets the coordinates of `out`.
void add_kept_points(const Cloud& cloud, Format format, const Context& context, Cloud& out) {
  Table points = cloud.points();
  const std::vector<std::size_t> kept = kept_fields(cloud, format, context);
  const bool same_fields = [&] {
    for (std::size_t k = 0; k < kept.size(); ++k)
      if (kept[k] != k) return false;
    return kept.size() == points.fields.size();
  }();
  make_words(points, context);  // only XYZ may have commas
  if (!same_fields) project(points, kept, context);
  for (std::size_t axis = 0; axis < 3; ++axis)
    out.xyz[axis] = std::size_t(std::find(kept.begin(), kept.end(), cloud.xyz[axis]) - kept.begin());
  for (Field& f : points.fields) f.spelling.clear();
  name_coordinates(points, out.xyz);
  fit_types(points, format, context);
  if (format == Format::xyz && points.fields.size() > 3) out.xyz_style.names = "# ";
  out.elements.push_back(std::move(points));
}

}  // namespace

bool is_writable_as_is(const Cloud& cloud, Format format) {
  if (format != cloud.format) return false;
  if (format == Format::ply) return has_ply_types(cloud.points());
  if (format != Format::off) return true;
  const std::vector<std::size_t> in_order = off_fields(cloud);
  const std::vector<Field>& fields = cloud.points().fields;
  std::size_t named = 0;  // OFF keeps unnamed columns between the named ones, ahead of texture coordinates
  for (std::size_t f = 0; f < fields.size(); ++f)
    if (!is_unnamed(fields[f]) && (named >= in_order.size() || in_order[named++] != f)) return false;
  return true;
}

std::vector<std::string> what_is_lost(const Cloud& cloud, Format format, Encoding encoding,
                                      const Context& context) {
  return losses_of(cloud, format, encoding, Digits::of_all, context);
}

std::vector<std::string> what_will_be_lost(const Cloud& cloud, const std::vector<Field>& added, Format format,
                                           Encoding encoding, const Context& context) {
  Losses lost = losses_of(cloud, format, encoding, Digits::of_others, context);
  Cloud fields = make_cloud(nullptr, 0);
  if (cloud.format != Format::las) fields.format = cloud.format;
  for (const Field& field : added)
    if (!find_field(cloud, field.name)) fields.points().fields.push_back(field);
  const Losses more = what_is_lost(fields, format, encoding, context);
  lost.insert(lost.end(), more.begin(), more.end());
  return lost;
}

std::vector<std::string> lost_of_triangles(Format format) {
  if (capacity_of(format).elements != Capacity::Elements::none) return {};
  return {"element 'face'"};
}

std::vector<std::string> lost_of_edges(Format format) {
  if (capacity_of(format).elements == Capacity::Elements::all) return {};
  return {"element 'edge'"};
}

void need_no_losses(const std::vector<std::string>& losses, Format format, Encoding encoding) {
  if (!losses.empty())
    fail(ErrorCode::usage, "{} ({}) cannot carry {}; `drop-unsupported` leaves that out", name_of(format),
         name_of(encoding), fmt::join(losses, ", "));
}

Cloud convert(const Cloud& cloud, Format format, const Context& context) {
  if (cloud.format == Format::las) return convert(plain_of_las(cloud, context), format, context);
  Cloud out;
  out.format = format;
  out.encoding = cloud.encoding;
  out.width = cloud.width;
  out.height = cloud.height;
  out.viewpoint = cloud.viewpoint;
  out.notes = cloud.notes;
  out.newline = cloud.newline;
  add_kept_points(cloud, format, context, out);
  add_kept_elements(cloud, format, context, out);
  rewrite_notes(out, cloud.format, format);
  if (format != Format::las) return out;
  make_binary(out.points(), context);  // after the comments between rows of text were taken
  return las_of_plain(out, positions(cloud, context), context);
}

Cloud as_cells(Cloud cloud, Separators separators, const Context& context) {
  make_cells(cloud.points(), separators, context);
  cloud.xyz_style.names = "";
  cloud.xyz_style.counted.reset();
  cloud.xyz_style.separator = cell_separator(separators);
  return cloud;
}

}  // namespace rfsmooth::pipeline::io
