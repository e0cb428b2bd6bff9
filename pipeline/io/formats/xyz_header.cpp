#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include <fmt/format.h>

#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/formats/xyz.h"

namespace rfsmooth::pipeline::io {
namespace {

using Axes = std::array<std::size_t, 3>;
using CoordinateNames = std::array<std::string_view, 3>;

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string_view without_line_end(std::string_view line) {
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

// What a line of names starts with: a comment sign and blanks, or nothing.
std::string_view prefix_of(std::string_view line) {
  return line.substr(0, std::min(line.find_first_not_of("#/ \t"), line.size()));
}

using Cells = std::vector<std::string_view>;

// What x, y and z are called, in lower case: also by surveyors and by ParaView.
constexpr CoordinateNames kNames[] = {{"x", "y", "z"},
                                      {"easting", "northing", "height"},
                                      {"easting", "northing", "elevation"},
                                      {"easting", "northing", "z"},
                                      {"e", "n", "h"},
                                      {"e", "n", "z"},
                                      {"x", "y", "height"},
                                      {"x", "y", "elevation"},
                                      {"x_coord", "y_coord", "z_coord"},
                                      {"points:0", "points:1", "points:2"},
                                      {"points_0", "points_1", "points_2"}};

// Where the first of that name is; as many as there are if none is.
std::size_t place_of(const std::vector<std::string>& all, std::string_view name) {
  return std::size_t(std::find(all.begin(), all.end(), name) - all.begin());
}

// Where those names are, unless one is missing, or another column is called x, y or z.
std::optional<Axes> places_of(const std::vector<std::string>& all, const CoordinateNames& names) {
  Axes axes{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    axes[axis] = place_of(all, names[axis]);
    const std::size_t plain = place_of(all, kNames[0][axis]);
    if (axes[axis] == all.size() || (plain != all.size() && plain != axes[axis])) return std::nullopt;
  }
  return axes;
}

// Where x, y and z are, and whether they are called so.
struct Coordinates {
  Axes axes;
  bool plain;
};

std::optional<Coordinates> coordinates_among(const Cells& cells) {
  std::vector<std::string> all;
  for (const std::string_view cell : cells) {
    std::string& name = all.emplace_back(name_in_cell(cell));
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
  }
  for (const CoordinateNames& names : kNames)
    if (const auto axes = places_of(all, names)) return Coordinates{*axes, &names == kNames};
  return std::nullopt;
}

// Whether a line names x, y and z, whatever stands between its names.
bool names_coordinates(std::string_view line) {
  for (const Separators s :
       {Separators::space_comma, Separators::comma, Separators::semicolon, Separators::tab})
    if (coordinates_among(words_as_written(line, s))) return true;
  return false;
}

// Whether a comment that names x, y and z, but not as many columns as there are, must be meant as their names
// all the same: then x, y, z are not the first three. A sentence is longer, or has a colon.
bool is_misfit(const Cells& cells, std::string_view line, std::size_t columns) {
  if (columns == 3 || cells.size() > columns + 1 || line.find_first_of(":=") != std::string_view::npos)
    return false;
  const auto found = coordinates_among(cells);
  return !found || found->axes != Axes{0, 1, 2};
}

void need_line_feeds(const TextCursor& cursor, std::string_view content) {
  if (content.find('\r') == std::string_view::npos) return;
  cursor.source.fail(
      "line {}: expected lines that end in LF or CR LF, found a CR alone, as old Macs wrote them; "
      "tr '\\r' '\\n' < IN > OUT mends the file",
      cursor.lines + 1);
}

// The line that names the columns, if there is one.
std::string names_line(const Cloud& cloud) {
  if (!cloud.xyz_style.names) return "";
  std::string out = *cloud.xyz_style.names;
  std::vector<std::string> cells = cloud.xyz_style.cells;
  const char separator = cloud.xyz_style.separator;
  const bool quoted = !cells.empty() && cells.front().substr(0, 1) == "\"";
  bool first = true;
  for (const Field& f : cloud.points().fields) {
    if (!first) out += separator;
    first = false;
    const auto cell = std::find_if(cells.begin(), cells.end(),
                                   [&](const std::string& c) { return name_in_cell(c) == f.name; });
    const std::string word = one_word(f.name);
    const std::string name = cell != cells.end() ? *cell : quoted ? '"' + word + '"' : word;
    const bool parted = separator != ' ' && name.find(separator) != std::string::npos;
    out += parted && name.front() != '"' ? '"' + name + '"' : name;
    if (cell != cells.end()) cells.erase(cell);  // a name may be there several times
  }
  return out + cloud.newline;
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

std::optional<Axes> xyz_coordinates(const std::vector<std::string>& names) {
  const auto found = coordinates_among(Cells(names.begin(), names.end()));
  if (!found || found->plain) return std::nullopt;
  return found->axes;
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
      cloud.xyz_style.notes_first = cloud.notes.size();
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
      if (cells.size() != columns || !coordinates_among(cells)) continue;
      const std::size_t between = names.line.find_first_of(",;\t");
      cloud.xyz_style.names = names.prefix;
      cloud.xyz_style.separator = between == std::string::npos ? ' ' : names.line[between];
      if (cell_separator(s) != '\0') cloud.xyz_style.separator = cell_separator(s);
      cloud.xyz_style.cells.assign(cells.begin(), cells.end());
      cloud.notes.erase(cloud.notes.begin() + std::ptrdiff_t(names.note));
      cloud.xyz_style.names_first = names.note < cloud.xyz_style.notes_first;
      if (cloud.xyz_style.names_first) --cloud.xyz_style.notes_first;
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
  const XyzStyle& style = cloud.xyz_style;
  const std::size_t first =
      style.counted ? std::min(style.notes_first, cloud.notes.size()) : cloud.notes.size();
  std::string out;
  for (std::size_t k = 0; k < first; ++k) out += cloud.notes[k].line + cloud.newline;
  if (!style.counted) return out + names_line(cloud);
  if (style.names_first) out += names_line(cloud);
  out += fmt::format("{}{}", cloud.size(), cloud.newline);
  for (std::size_t k = first; k < cloud.notes.size(); ++k) out += cloud.notes[k].line + cloud.newline;
  return style.names_first ? out : out + names_line(cloud);
}

}  // namespace rfsmooth::pipeline::io
