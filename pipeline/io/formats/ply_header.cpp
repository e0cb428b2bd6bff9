#include <utility>

#include <fmt/format.h>

#include "pipeline/io/formats/ply.h"

namespace rfsmooth::pipeline::io {
namespace {

// The first name of each type is the one we write.
constexpr std::pair<std::string_view, Scalar> kTypes[] = {
    {"char", Scalar::int8},       {"uchar", Scalar::uint8},    {"short", Scalar::int16},
    {"ushort", Scalar::uint16},   {"int", Scalar::int32},      {"uint", Scalar::uint32},
    {"float", Scalar::float32},   {"double", Scalar::float64}, {"int8", Scalar::int8},
    {"uint8", Scalar::uint8},     {"int16", Scalar::int16},    {"uint16", Scalar::uint16},
    {"int32", Scalar::int32},     {"uint32", Scalar::uint32},  {"float32", Scalar::float32},
    {"float64", Scalar::float64}, {"int64", Scalar::int64},    {"uint64", Scalar::uint64},
};

std::string_view ply_type(Scalar type) {
  for (const auto& [name, t] : kTypes)
    if (t == type) return name;
  throw std::logic_error("every Scalar has a PLY name");
}

Scalar parse_type(std::string_view word, const HeaderLines& lines) {
  for (const auto& [name, type] : kTypes)
    if (name == word) return type;
  lines.fail("expected a type (char, uchar, short, ushort, int, uint, float, double), found {}",
             in_quotes(word));
}

Encoding parse_format(std::string_view word, const HeaderLines& lines) {
  for (const Encoding e : {Encoding::ascii, Encoding::binary_little_endian, Encoding::binary_big_endian})
    if (name_of(e) == word) return e;
  lines.fail("expected format ascii, binary_little_endian or binary_big_endian, found {}", in_quotes(word));
}

Table parse_element(std::string_view rest, const HeaderLines& lines) {
  Table table;
  table.name = next_word(rest);
  const std::string_view count = next_word(rest);
  const auto rows = parse_count(count);
  if (table.name.empty() || !rows)
    lines.fail("expected 'element NAME COUNT', found a count of {}", in_quotes(count));
  table.count = std::size_t(*rows);
  if (!next_word(rest).empty()) lines.fail("expected 'element NAME COUNT', found more words");
  return table;
}

Field parse_property(std::string_view rest, const HeaderLines& lines) {
  Field field;
  const std::string_view word = next_word(rest);
  if (word == "list") {
    const std::string_view count = next_word(rest);
    field.list_count = parse_type(count, lines);
    if (is_float(*field.list_count))
      lines.fail("expected a whole-number type for a list's length, found {}", in_quotes(count));
    const std::string_view type = next_word(rest);
    field.type = parse_type(type, lines);
    field.spelling = fmt::format("list {} {}", count, type);
  } else {
    field.type = parse_type(word, lines);
    field.spelling = word;
  }
  field.name = next_word(rest);
  if (field.name.empty()) lines.fail("expected 'property TYPE NAME', found no name");
  if (!next_word(rest).empty()) lines.fail("expected 'property TYPE NAME', found more words");
  return field;
}

void append_notes(std::string& out, const Cloud& cloud, std::size_t element, std::size_t from,
                  std::size_t to) {
  for (const Note& note : cloud.notes)
    if (note.element == element && note.field >= from && note.field < to) out += note.line + cloud.newline;
}

}  // namespace

bool is_ply_line(std::string_view line) {
  return words_of(line) == std::vector<std::string_view>{"ply"};
}

Cloud read_ply_header(HeaderLines& lines) {
  Cloud cloud;
  cloud.format = Format::ply;
  if (const std::string_view first = lines.next("'ply'"); !is_ply_line(first))
    lines.fail("expected 'ply', found {}", in_quotes(first));
  cloud.newline = lines.crlf() ? "\r\n" : "\n";
  bool format_seen = false;
  for (;;) {
    const std::string_view line = lines.next("'end_header'");
    std::string_view rest = line;
    const std::string_view keyword = next_word(rest);
    if (keyword == "end_header") break;
    if (keyword.empty()) continue;
    if (keyword == "comment" || keyword == "obj_info") {
      Note note{std::string(line)};
      if (!format_seen) {
        note.element = Note::kBeforeFormat;
      } else if (!cloud.elements.empty()) {
        // Behind the last property so far; moved on by one element if another element's line follows.
        note.element = cloud.elements.size() - 1;
        note.field = cloud.elements.back().fields.size() + 1;
      }
      cloud.notes.push_back(std::move(note));
    } else if (keyword == "format") {
      if (format_seen) lines.fail("expected one format line, found a second");
      cloud.encoding = parse_format(next_word(rest), lines);
      format_seen = true;
    } else if (keyword == "element") {
      cloud.elements.push_back(parse_element(rest, lines));
    } else if (keyword == "property") {
      if (cloud.elements.empty()) lines.fail("expected an element line before the first property");
      cloud.elements.back().fields.push_back(parse_property(rest, lines));
    } else {
      lines.fail("expected format, element, property, comment, obj_info or end_header, found {}",
                 in_quotes(keyword));
    }
  }
  if (!format_seen) lines.fail("expected a format line before end_header");
  for (const Table& t : cloud.elements)
    if (t.fields.empty() && t.count > 0)
      lines.fail("expected properties of element '{}', found none", t.name);
  cloud.original_header = lines.text();
  cloud.original_canonical = ply_header(cloud, cloud.encoding);
  return cloud;
}

std::string ply_header(const Cloud& cloud, Encoding encoding) {
  const std::string& newline = cloud.newline;
  std::string out = "ply" + newline;
  append_notes(out, cloud, Note::kBeforeFormat, 0, 1);
  out += fmt::format("format {} 1.0{}", name_of(encoding), newline);
  for (std::size_t e = 0; e < cloud.elements.size(); ++e) {
    const Table& table = cloud.elements[e];
    append_notes(out, cloud, e, 0, 1);
    out += fmt::format("element {} {}{}", table.name, table.count, newline);
    for (std::size_t f = 0; f < table.fields.size(); ++f) {
      const Field& field = table.fields[f];
      append_notes(out, cloud, e, f + 1, f + 2);
      std::string type = field.spelling;
      if (type.empty() && field.is_list())
        type = fmt::format("list {} {}", ply_type(*field.list_count), ply_type(field.type));
      if (type.empty()) type = ply_type(field.type);
      out += fmt::format("property {} {}{}", type, one_word(field.name), newline);
    }
    append_notes(out, cloud, e, table.fields.size() + 1, std::size_t(-1));
  }
  if (cloud.elements.empty()) append_notes(out, cloud, 0, 0, 1);
  return out + "end_header" + newline;
}

}  // namespace rfsmooth::pipeline::io
