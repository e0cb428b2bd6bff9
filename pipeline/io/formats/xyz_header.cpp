#include <algorithm>

#include <fmt/format.h>

#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/formats/xyz.h"

namespace rfsmooth::pipeline::io {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string_view without_line_end(std::string_view line) {
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

// What a line of names starts with: a comment sign and blanks, or nothing.
std::string_view prefix_of(std::string_view line) {
  return line.substr(0, std::min(line.find_first_not_of("#/ \t"), line.size()));
}

bool is_axis(std::string_view cell, std::size_t axis) {
  const std::string name = name_in_cell(cell);
  return name.size() == 1 && (name[0] == char('x' + axis) || name[0] == char('X' + axis));
}

using Cells = std::vector<std::string_view>;

// Where the first cell that names the axis is; as many as there are cells if none does.
std::size_t place_of_axis(const Cells& cells, std::size_t axis) {
  return std::size_t(std::find_if(cells.begin(), cells.end(), [&](auto c) { return is_axis(c, axis); }) -
                     cells.begin());
}

bool names_coordinates(const Cells& cells) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (place_of_axis(cells, axis) == cells.size()) return false;
  return true;
}

// Whether a line names x, y and z, whatever stands between its names.
bool names_coordinates(std::string_view line) {
  for (const Separators s :
       {Separators::space_comma, Separators::comma, Separators::semicolon, Separators::tab})
    if (names_coordinates(words_as_written(line, s))) return true;
  return false;
}

// Whether a comment that names x, y and z, but not as many columns as there are, must be meant as their names
// all the same: then x, y, z are not the first three. A sentence is longer, or has a colon.
bool is_misfit(const Cells& cells, std::string_view line, std::size_t columns) {
  if (columns == 3 || cells.size() > columns + 1 || line.find_first_of(":=") != std::string_view::npos)
    return false;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (place_of_axis(cells, axis) != axis) return true;
  return false;
}

void need_line_feeds(const TextCursor& cursor, std::string_view content) {
  if (content.find('\r') == std::string_view::npos) return;
  cursor.source.fail(
      "line {}: expected lines that end in LF or CR LF, found a CR alone, as old Macs wrote them; "
      "tr '\\r' '\\n' < IN > OUT mends the file",
      cursor.lines + 1);
}

}  // namespace

std::string name_in_cell(std::string_view cell) {
  cell = without_quotes(without_blanks(cell));
  if (!cell.empty() && (cell.back() == ']' || cell.back() == ')'))
    if (const std::size_t unit = cell.rfind(cell.back() == ']' ? '[' : '(');
        unit != std::string_view::npos && unit > 0)
      cell = cell.substr(0, unit);
  std::string name(without_blanks(cell));
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '\t'; }, '_');
  return name;
}

std::vector<XyzNames> read_xyz_beginning(TextCursor& cursor, Cloud& cloud) {
  std::vector<XyzNames> out;
  if (cursor.rest().substr(0, kByteOrderMark.size()) == kByteOrderMark) cursor.at += kByteOrderMark.size();
  bool named = false;  // by a line that is no comment
  for (;; skip_line(cursor)) {
    const std::string_view line = peek_line(cursor);
    if (line.empty()) break;
    if (cursor.lines == 0 && line.size() > 1 && line[line.size() - 2] == '\r') cloud.newline = "\r\n";
    const std::string_view content = without_line_end(line);
    const std::string_view prefix = prefix_of(content), rest = content.substr(prefix.size());
    const bool comment = is_blank_or_comment(line);
    if (!comment) need_line_feeds(cursor, content);  // the comments of other formats may hold a CR
    const auto words = words_of(rest);
    if (!named && names_coordinates(rest)) {
      named = !comment;
      out.push_back({std::string(prefix), std::string(rest), comment, cursor.lines + 1, cloud.notes.size()});
      cloud.notes.push_back({std::string(content)});  // given up when it turns out to be the names
    } else if (comment) {
      if (!words.empty()) cloud.notes.push_back({std::string(content)});
    } else if (words.size() == 1 && parse_count(words[0]) && !cloud.xyz_style.counted) {
      cloud.xyz_style.counted = parse_count(words[0]);
    } else {
      break;
    }
  }
  return out;
}

std::vector<std::string> take_xyz_names(const std::vector<XyzNames>& lines, std::size_t columns,
                                        Separators separators, const Source& source, Cloud& cloud) {
  for (const XyzNames& names : lines)
    for (const Separators s : {separators, Separators::space_comma}) {
      const Cells cells = words_as_written(names.line, s);
      if (cells.size() != columns || !names_coordinates(cells)) continue;
      const std::size_t between = names.line.find_first_of(",;\t");
      cloud.xyz_style.names = names.prefix;
      cloud.xyz_style.separator = between == std::string::npos ? ' ' : names.line[between];
      if (cell_separator(s) != '\0') cloud.xyz_style.separator = cell_separator(s);
      cloud.xyz_style.cells.assign(cells.begin(), cells.end());
      cloud.notes.erase(cloud.notes.begin() + std::ptrdiff_t(names.note));
      return cloud.xyz_style.cells;
    }
  for (const XyzNames& names : lines)
    if (const Cells cells = words_as_written(names.line, separators);
        !names.comment || is_misfit(cells, names.line, columns))
      source.fail(
          "line {}: expected names for {} columns, as the rows have, found {} in {}; name every column, or "
          "take the line out if the first three are x, y, z",
          names.number, columns, cells.size(), in_quotes(names.line));
  return {};
}

std::string xyz_header(const Cloud& cloud) {
  std::string out;
  for (const Note& note : cloud.notes) out += note.line + cloud.newline;
  if (cloud.xyz_style.names) {
    out += *cloud.xyz_style.names;
    std::vector<std::string> cells = cloud.xyz_style.cells;
    const char separator = cloud.xyz_style.separator;
    const bool quoted = !cells.empty() && cells.front().substr(0, 1) == "\"";
    bool first = true;
    for (const Field& f : cloud.points().fields) {
      if (!first) out += separator;
      first = false;
      const auto cell = std::find_if(cells.begin(), cells.end(),
                                     [&](const std::string& c) { return name_in_cell(c) == f.name; });
      const std::string name = cell != cells.end() ? *cell : quoted ? '"' + f.name + '"' : f.name;
      const bool parted = separator != ' ' && name.find(separator) != std::string::npos;
      out += parted && name.front() != '"' ? '"' + name + '"' : name;
      if (cell != cells.end()) cells.erase(cell);  // a name may be there several times
    }
    out += cloud.newline;
  }
  if (cloud.xyz_style.counted) out += fmt::format("{}{}", cloud.size(), cloud.newline);
  return out;
}

}  // namespace rfsmooth::pipeline::io
