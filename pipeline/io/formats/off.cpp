#include "pipeline/io/formats/off.h"

#include <fmt/format.h>

#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/formats/ply.h"
#include "pipeline/io/table/rows.h"

namespace rfsmooth::pipeline::io {
namespace {

struct Kind {
  bool texture = false, colour = false, normals = false, other_dimension = false;
};

// Takes the prefixes off `word`, in any order; false if the rest is not OFF.
bool parse_kind(std::string_view word, Kind& kind) {
  const auto take = [&](std::string_view prefix, bool& seen) {
    if (seen || word.substr(0, prefix.size()) != prefix) return false;
    word.remove_prefix(prefix.size());
    return seen = true;
  };
  bool four = false, any = false;
  while (take("ST", kind.texture) || take("C", kind.colour) || take("N", kind.normals) || take("4", four) ||
         take("n", any)) {
  }
  kind.other_dimension = four || any;
  return word == "OFF";
}

struct Counts {
  std::size_t vertices = 0, faces = 0;
};

std::size_t element_count(std::string_view word, const TextCursor& cursor, const char* what) {
  const auto value = parse_count(word);
  if (!value)
    cursor.source.fail("line {}: expected the number of {}, found {}", cursor.lines, what,
                       word.empty() ? "the end of the line" : in_quotes(word));
  return std::size_t(*value);
}

// The next line that is no comment. Comments before and in it become notes.
std::string_view next_content(TextCursor& cursor, const char* expected, std::vector<Note>& notes) {
  for (;;) {
    const std::string_view line = peek_line(cursor);
    if (line.empty())
      cursor.source.fail("line {}: expected {}, found the end of the file", cursor.lines + 1, expected);
    skip_line(cursor);
    const std::string_view plain = line.substr(0, line.find_last_not_of("\r\n") + 1);
    const std::size_t sign = plain.find('#');
    if (sign != std::string_view::npos) notes.push_back({std::string(plain.substr(sign))});
    if (!is_blank_or_comment(line)) return line.substr(0, line.find('#'));
  }
}

Counts read_header(TextCursor& cursor, Kind& kind, std::vector<Note>& notes) {
  std::string_view line = next_content(cursor, "'OFF'", notes);
  const std::string_view word = next_word(line);
  if (!parse_kind(word, kind))
    cursor.source.fail("line {}: expected 'OFF', found {}", cursor.lines, in_quotes(word));
  if (kind.other_dimension)
    cursor.source.fail("line {}: expected vertices of 3 coordinates, found {}", cursor.lines,
                       in_quotes(word));
  std::string_view first = next_word(line);
  if (first == "BINARY")
    cursor.source.fail("line {}: expected an ascii OFF file, found BINARY", cursor.lines);
  if (first.empty()) {
    line = next_content(cursor, "the numbers of vertices, faces and edges", notes);
    first = next_word(line);
  }
  Counts counts;
  counts.vertices = element_count(first, cursor, "vertices");
  counts.faces = element_count(next_word(line), cursor, "faces");
  const std::string_view edges = next_word(line);  // often 0, sometimes missing, never used
  if (!edges.empty()) element_count(edges, cursor, "edges");
  return counts;
}

// The number of values in the first line that has any. The cursor stays where it is.
std::size_t columns_ahead(TextCursor& cursor) {
  const std::size_t at = cursor.at, lines = cursor.lines;
  while (cursor.at < cursor.all.size() && is_blank_or_comment(peek_line(cursor))) skip_line(cursor);
  const std::size_t columns = words_of(peek_line(cursor)).size();
  cursor.at = at;
  cursor.lines = lines;
  return columns;
}

std::vector<Field> vertex_fields(const Kind& kind, std::size_t columns) {
  std::vector<std::string> names = {"x", "y", "z"};
  if (kind.normals) names.insert(names.end(), {"nx", "ny", "nz"});
  const std::size_t behind = kind.texture ? 2 : 0;
  const std::size_t extra = columns > names.size() + behind ? columns - names.size() - behind : 0;
  // Some writers leave the C out; three or four values more are colours.
  if (kind.colour || extra == 3 || extra == 4) {
    names.insert(names.end(), {"red", "green", "blue"});
    if (extra == 4) names.emplace_back("alpha");
  } else {
    for (std::size_t k = 0; k < extra; ++k) names.push_back(fmt::format("column_{}", names.size() + 1));
  }
  if (kind.texture) names.insert(names.end(), {"s", "t"});
  std::vector<Field> fields;
  for (std::string& name : names) fields.push_back({std::move(name), Scalar::float64});
  return fields;
}

/// Everything before the first vertex, as we write it: prefixes by the points' fields.
std::string off_header(const Cloud& cloud) {
  const auto has = [&](const char* name) { return find_field(cloud, name).has_value(); };
  std::string out;
  if (has("s") && has("t")) out += "ST";
  if (has("red")) out += "C";
  if (has("nx")) out += "N";
  out += "OFF" + cloud.newline;
  for (const Note& note : cloud.notes) out += note.line + cloud.newline;
  const Table* faces = cloud.element("face");
  return out + fmt::format("{} {} 0{}", cloud.size(), faces == nullptr ? 0 : faces->count, cloud.newline);
}

}  // namespace

bool is_off_word(std::string_view word) {
  Kind kind;
  return parse_kind(word, kind);
}

Cloud read_off(const Source& source, const Context& context) {
  Cloud cloud;
  cloud.format = Format::off;
  cloud.encoding = Encoding::ascii;
  TextCursor cursor(source, 0, 0, context);
  Kind kind;
  const Counts counts = read_header(cursor, kind, cloud.notes);
  cloud.original_header.assign(cursor.all.data(), cursor.at);
  if (cloud.original_header.find("\r\n") != std::string::npos) cloud.newline = "\r\n";

  Table points;
  points.name = "vertex";
  points.fields = vertex_fields(kind, counts.vertices > 0 ? columns_ahead(cursor) : 0);
  points.count = counts.vertices;
  read_text_rows(points, cursor, context);
  Table faces;
  faces.name = "face";
  faces.fields.push_back({"vertex_indices", Scalar::int32, 1, Scalar::uint32});
  faces.count = counts.faces;
  faces.ragged = true;
  read_text_rows(faces, cursor, context);
  cloud.tail = cursor.rest();
  warn_of_tail(cloud, source, context);
  cloud.elements.push_back(std::move(points));
  cloud.elements.push_back(std::move(faces));
  find_coordinates(cloud, source, context);
  cloud.width = cloud.size();
  cloud.original_canonical = off_header(cloud);
  return cloud;
}

std::vector<std::size_t> off_fields(const Cloud& cloud) {
  std::vector<std::size_t> fields(cloud.xyz.begin(), cloud.xyz.end());
  const auto take = [&](std::initializer_list<const char*> names) {
    std::vector<std::size_t> found;
    for (const char* name : names)
      if (const auto f = find_plain_field(cloud, name)) found.push_back(*f);
    if (found.size() != names.size()) return false;
    fields.insert(fields.end(), found.begin(), found.end());
    return true;
  };
  take({"nx", "ny", "nz"});
  if (take({"red", "green", "blue"})) take({"alpha"});
  take({"s", "t"});
  return fields;
}

void write_off(const Cloud& cloud, Sink& sink, const Context& context) {
  sink.write(cloud.header(off_header(cloud)));
  std::vector<const Table*> tables = {&cloud.points()};
  if (const Table* faces = cloud.element("face")) tables.push_back(faces);
  write_text_body(tables, cloud.tail, sink, context);
}

}  // namespace rfsmooth::pipeline::io
