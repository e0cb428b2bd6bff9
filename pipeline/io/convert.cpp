#include "pipeline/io/convert.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/formats/las/las_plain.h"
#include "pipeline/io/formats/off.h"
#include "pipeline/io/mesh_file.h"

namespace rfsmooth::pipeline::io {
namespace {

constexpr std::string_view kNoViewpoint = "0 0 0 1 0 0 0";
constexpr std::string_view kPadding = "_";

// The length of the field's list in every row, if it is the same in all and not zero.
std::optional<std::size_t> constant_length(const Table& table, std::size_t field, const Context& context) {
  const Lists lists = gather_lists(table, field, context);
  if (table.count == 0) return std::nullopt;
  const std::uint64_t n = lists.start[1];
  for (std::size_t i = 0; i < table.count; ++i)
    if (lists.start[i + 1] - lists.start[i] != n) return std::nullopt;
  if (n == 0) return std::nullopt;
  return std::size_t(n);
}

bool is_padding(const Field& f) {
  return f.name == kPadding;
}

bool carries(const Cloud& cloud, std::size_t field, Format format, const Context& context) {
  const Field& f = cloud.points().fields[field];
  const bool is_64_bit_integer = f.type == Scalar::int64 || f.type == Scalar::uint64;
  switch (format) {
    case Format::ply:
      return !is_64_bit_integer;
    case Format::pcd:
      return !f.is_list() || constant_length(cloud.points(), field, context).has_value();
    case Format::xyz:
      return f.is_plain();
    case Format::off: {
      const std::vector<std::size_t> known = off_fields(cloud);
      return std::find(known.begin(), known.end(), field) != known.end();
    }
    case Format::las:
      return is_las_field(f);
  }
  return false;
}

// OFF's columns have no names: those of a file that OFF has no word for stay, one that was added is lost.
bool is_unnamed(const Field& f) {
  return f.name.rfind("column_", 0) == 0;
}

bool is_coordinate(const Cloud& cloud, std::size_t field) {
  return std::find(cloud.xyz.begin(), cloud.xyz.end(), field) != cloud.xyz.end();
}

// The fields of the points that go along, in the target's order.
std::vector<std::size_t> kept_fields(const Cloud& cloud, Format format, const Context& context) {
  if (format == Format::off) return off_fields(cloud);
  std::vector<std::size_t> kept;
  // Columns without names are x, y, z first.
  if (format == Format::xyz) kept.assign(cloud.xyz.begin(), cloud.xyz.end());
  for (std::size_t f = 0; f < cloud.points().fields.size(); ++f)
    if (!is_padding(cloud.points().fields[f]) && std::find(kept.begin(), kept.end(), f) == kept.end() &&
        (is_coordinate(cloud, f) || carries(cloud, f, format, context)))
      kept.push_back(f);
  return kept;
}

bool has_points_only(Format format) {
  return format == Format::pcd || format == Format::xyz || format == Format::las;
}

bool float_digits_lost(const Table& table, std::size_t field, const Context& context) {
  if (!table.text || table.fields[field].type != Scalar::float32 || !table.fields[field].is_plain())
    return false;
  // Text says what it says; only bytes have a width.
  return !text_fits_float32(table, {field}, context);
}

std::string_view without_keyword(std::string_view line) {
  for (const std::string_view keyword : {"comment", "#", "//"})
    if (line.substr(0, keyword.size()) == keyword) {
      line.remove_prefix(keyword.size());
      break;
    }
  while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
  return line;
}

// The value of "obj_info KEY VALUE", if the line is that.
std::optional<std::string_view> info_value(std::string_view line, std::string_view key) {
  const char* p = line.data();
  const char* end = p + line.size();
  if (next_word(p, end) != "obj_info" || next_word(p, end) != key) return std::nullopt;
  while (p != end && *p == ' ') ++p;
  return std::string_view(p, std::size_t(end - p));
}

bool is_viewpoint(std::string_view text) {
  const std::vector<std::string_view> words = words_of(text);
  return words.size() == 7 && std::all_of(words.begin(), words.end(), parse_real);
}

// PLY's obj_info lines that say what PCD has words for; they leave the notes.
void take_grid_and_viewpoint(Cloud& cloud) {
  std::size_t columns = 0, rows = 0;
  for (const Note& note : cloud.notes) {
    if (const auto v = info_value(note.line, "num_cols")) columns = parse_count(*v).value_or(0);
    if (const auto v = info_value(note.line, "num_rows")) rows = parse_count(*v).value_or(0);
    if (const auto v = info_value(note.line, "viewpoint"); v && is_viewpoint(*v)) cloud.viewpoint = *v;
  }
  const bool grid = columns > 0 && rows > 0 && cloud.size() % columns == 0 && cloud.size() / columns == rows;
  if (grid) {
    cloud.width = columns;
    cloud.height = rows;
  }
  const auto taken = [&](const Note& note) {
    return (grid && (info_value(note.line, "num_cols") || info_value(note.line, "num_rows"))) ||
           info_value(note.line, "viewpoint") == std::optional<std::string_view>(cloud.viewpoint);
  };
  cloud.notes.erase(std::remove_if(cloud.notes.begin(), cloud.notes.end(), taken), cloud.notes.end());
}

void rewrite_notes(Cloud& cloud, Format from, Format to) {
  // Comments between text rows go into the header, where every format has a place for them.
  for (Table& table : cloud.elements) {
    for (const Interlude& between : table.interludes) {
      const char* p = between.text.data();
      const char* end = p + between.text.size();
      while (p != end) {
        const char* newline = std::find(p, end, '\n');
        std::string_view line(p, std::size_t(newline - p));
        while (!line.empty() && is_separator(line.back(), Separators::space)) line.remove_suffix(1);
        if (!line.empty()) cloud.notes.push_back({std::string(line)});
        p = newline == end ? end : newline + 1;
      }
    }
    table.interludes.clear();
  }
  if (from == Format::ply) take_grid_and_viewpoint(cloud);
  const bool as_ply = to == Format::ply || to == Format::las;  // the texts of LAS are what PLY would say
  const char* keyword = as_ply ? "comment " : "# ";
  for (Note& note : cloud.notes) {
    const bool info = from == Format::ply && note.line.substr(0, 8) == "obj_info";
    note = Note{keyword + std::string(info ? std::string_view(note.line) : without_keyword(note.line))};
    // Read again as ours: a comment "obj_info ..." of another format is obj_info in PLY.
    if (as_ply && note.line.substr(8, 9) == "obj_info ") note.line.erase(0, 8);
  }
  if (!as_ply) return;
  if (cloud.organised()) {
    cloud.notes.push_back({fmt::format("obj_info num_cols {}", cloud.width)});
    cloud.notes.push_back({fmt::format("obj_info num_rows {}", cloud.height)});
  }
  if (cloud.viewpoint != kNoViewpoint) cloud.notes.push_back({"obj_info viewpoint " + cloud.viewpoint});
}

// PLY has no 64-bit whole numbers; coordinates of that type, which cannot be left out, become doubles.
void widen_coordinates(Table& table, const Context& context) {
  const bool text = table.text;
  for (Field& field : table.fields) {
    if (field.type != Scalar::int64 && field.type != Scalar::uint64) continue;
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

// OFF's faces have no type for their counts; PLY's usual one is uchar.
void narrow_face_counts(Table& faces, const Context& context) {
  if (!faces.text || faces.fields.empty() || !faces.fields[0].is_list()) return;
  const Lists lists = gather_lists(faces, 0, context);
  for (std::size_t i = 0; i < faces.count; ++i)
    if (lists.start[i + 1] - lists.start[i] > 255) return;
  faces.fields[0].list_count = Scalar::uint8;
}

bool has_ragged_values(const Table& table, const Context& context) {
  if (!table.ragged) return false;
  const Lists lists = gather_lists(table, 0, context);
  for (std::size_t i = 0; i < table.count; ++i) {
    const std::string_view row = table.row(i);
    const char* p = row.data();
    for (std::uint64_t k = 0; k <= lists.start[i + 1] - lists.start[i]; ++k)
      next_word(p, row.data() + row.size());
    if (!next_word(p, row.data() + row.size()).empty()) return true;
  }
  return false;
}

}  // namespace

Encoding target_encoding(const Cloud& cloud, Format format, std::optional<Encoding> wanted) {
  Encoding e = wanted.value_or(cloud.encoding);
  if (format == Format::las && (!wanted || e == Encoding::binary_little_endian))
    return Encoding::binary_little_endian;
  const bool text_only = format == Format::xyz || format == Format::off;
  const bool known = (e == Encoding::ascii && format != Format::las) ||
                     (!text_only && e == Encoding::binary_little_endian) ||
                     (format == Format::ply && e == Encoding::binary_big_endian) ||
                     (format == Format::pcd && e == Encoding::binary_compressed);
  if (known) return e;
  if (wanted) fail(ErrorCode::usage, "{} has no encoding {}", name_of(format), name_of(e));
  return text_only ? Encoding::ascii : Encoding::binary_little_endian;
}

bool is_writable_as_is(const Cloud& cloud, Format format) {
  if (format != cloud.format) return false;
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
  std::vector<std::string> lost;
  if (cloud.format == Format::las && format != Format::las) {
    Cloud fields = make_cloud(nullptr, 0);
    fields.points().fields = plain_fields(cloud);
    lost = what_is_lost(fields, format, encoding, context);
    const std::vector<std::string> more = las_losses(cloud);
    lost.insert(lost.end(), more.begin(), more.end());
    return lost;
  }
  const Table& points = cloud.points();
  const bool as_is = is_writable_as_is(cloud, format);
  for (std::size_t f = 0; f < points.fields.size(); ++f) {
    const Field& field = points.fields[f];
    const bool kept = (as_is && (format != Format::off || is_unnamed(field))) || is_padding(field) ||
                      carries(cloud, f, format, context);
    if (!kept)
      lost.push_back(fmt::format("field '{}'", field.name));
    else if (encoding != Encoding::ascii && !(format == Format::las && is_coordinate(cloud, f)) &&
             float_digits_lost(points, f, context))
      lost.push_back(fmt::format("all digits of field '{}' (float32)", field.name));
  }
  if (format == cloud.format) return lost;
  for (std::size_t e = 0; e < cloud.elements.size(); ++e) {
    const Table& table = cloud.elements[e];
    if (e == cloud.vertex || table.count == 0) continue;
    const bool faces = table.name == "face" && polygon_field(table);
    if (has_points_only(format) || (format == Format::off && !faces)) {
      lost.push_back(fmt::format("element '{}'", table.name));
    } else if (format == Format::off) {
      for (std::size_t f = 0; f < table.fields.size(); ++f)
        if (f != *polygon_field(table))
          lost.push_back(fmt::format("field '{}' of the faces", table.fields[f].name));
    } else if (has_ragged_values(table, context)) {
      lost.push_back("colours of the faces");
    }
  }
  if (format == Format::las)
    if (const std::size_t n = cloud.size() - finite_rows(positions(cloud, context), context); n > 0)
      lost.push_back(fmt::format("{} points that are not finite", n));
  if (format == Format::xyz || format == Format::off) {
    if (cloud.organised()) lost.push_back(fmt::format("the grid of {} x {}", cloud.width, cloud.height));
    if (cloud.viewpoint != kNoViewpoint) lost.push_back("the viewpoint");
  }
  return lost;
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

  Table points = cloud.points();
  std::vector<std::size_t> kept = kept_fields(cloud, format, context);
  const bool same_fields = [&] {
    for (std::size_t k = 0; k < kept.size(); ++k)
      if (kept[k] != k) return false;
    return kept.size() == points.fields.size();
  }();
  // Text with commas is written anew as well: only XYZ may have them.
  if (!same_fields || points.separators != Separators::space) project(points, kept, context);
  for (std::size_t axis = 0; axis < 3; ++axis)
    out.xyz[axis] = std::size_t(std::find(kept.begin(), kept.end(), cloud.xyz[axis]) - kept.begin());
  for (Field& f : points.fields) f.spelling.clear();
  if (format == Format::ply) {
    widen_coordinates(points, context);
    arrays_to_lists(points, context);
  }
  if (format == Format::pcd) lists_to_arrays(points, context);
  if (format == Format::xyz && points.fields.size() > 3) out.xyz_style.names = "# ";
  out.elements.push_back(std::move(points));
  for (std::size_t e = 0; e < cloud.elements.size(); ++e) {
    if (e == cloud.vertex || has_points_only(format)) continue;
    Table table = cloud.elements[e];
    const auto list = polygon_field(table);
    if (format == Format::off && (table.name != "face" || !list)) continue;
    const bool bare = format == Format::off && cloud.format != Format::off;
    if (bare || (table.ragged && format != Format::off)) project(table, {*list}, context);
    if (cloud.format == Format::off) narrow_face_counts(table, context);
    out.elements.push_back(std::move(table));
  }
  rewrite_notes(out, cloud.format, format);
  if (format != Format::las) return out;
  make_binary(out.points(), context);
  return las_of_plain(out, positions(cloud, context), context);
}

}  // namespace rfsmooth::pipeline::io
