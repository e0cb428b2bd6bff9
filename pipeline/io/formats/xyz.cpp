#include "pipeline/io/formats/xyz.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <fmt/format.h>

#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/formats/ply.h"
#include "pipeline/io/point_fields.h"
#include "pipeline/io/table/rows.h"

namespace rfsmooth::pipeline::io {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string_view without_line_end(std::string_view line) {
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

// What a line of names starts with: a comment sign and blanks, or nothing.
std::string_view prefix_of(std::string_view line) {
  std::size_t n = 0;
  while (n < line.size() && (line[n] == '#' || line[n] == '/' || line[n] == ' ' || line[n] == '\t')) ++n;
  return line.substr(0, n);
}

bool has_word(const std::vector<std::string_view>& words, char lower) {
  const std::string low(1, lower), high(1, char(lower - 'a' + 'A'));
  return std::any_of(words.begin(), words.end(), [&](std::string_view w) { return w == low || w == high; });
}

bool names_coordinates(const std::vector<std::string_view>& words) {
  return has_word(words, 'x') && has_word(words, 'y') && has_word(words, 'z');
}

// "1,5 2,5 3,5" and "1,5;2,5;3,5": read as six columns, such a file would be silently wrong. Who writes
// decimal points does not write decimal commas.
bool has_decimal_commas(std::string_view line) {
  if (line.find('.') != std::string_view::npos) return false;
  bool inner = false, other = false;
  for (std::size_t k = 1; k + 1 < line.size(); ++k) {
    const bool between = line[k - 1] >= '0' && line[k - 1] <= '9' && line[k + 1] >= '0' && line[k + 1] <= '9';
    inner = inner || (line[k] == ',' && between);
    other = other || line[k] == ';' || ((line[k] == ' ' || line[k] == '\t') && between);
  }
  return inner && other;
}

// Reads up to the first point. Returns the names of the columns, if a line gives them; those of a comment
// count only if there are as many as columns.
std::vector<std::string> read_beginning(TextCursor& cursor, Cloud& cloud) {
  std::vector<std::string> names;
  if (cursor.rest().substr(0, kByteOrderMark.size()) == kByteOrderMark) cursor.at += kByteOrderMark.size();
  for (;;) {
    const std::string_view line = peek_line(cursor);
    if (line.empty()) break;
    if (cursor.lines == 0 && line.size() > 1 && line[line.size() - 2] == '\r') cloud.newline = "\r\n";
    const std::string_view content = without_line_end(line);
    const std::string_view prefix = prefix_of(content);
    const auto words = words_of(content.substr(prefix.size()), Separators::space_comma);
    const bool comment = is_blank_or_comment(line);
    if (names_coordinates(words) && !cloud.xyz_style.names) {
      names.assign(words.begin(), words.end());
      cloud.xyz_style.names = std::string(prefix);
      const std::size_t comma = content.find_first_of(",;\t");
      cloud.xyz_style.separator = comma == std::string_view::npos ? ' ' : content[comma];
      cloud.notes.push_back({std::string(content), 1});  // given up below if it turns out to be the names
    } else if (comment) {
      if (!words.empty()) cloud.notes.push_back({std::string(content)});
    } else if (words.size() == 1 && parse_integer(words[0], Scalar::uint64) && !cloud.xyz_style.counted) {
      cloud.xyz_style.counted = true;
    } else {
      break;
    }
    skip_line(cursor);
  }
  return names;
}

// What one row says of three columns being a normal: flags, one of them set, have its length, too.
enum class Says { normal, normal_or_flags, nothing, no };

Says says_of_normal(const Eigen::Vector3d& v) {
  constexpr double kRounded = 0.02;                         // off 1, of components written with two digits
  if (!v.allFinite() || v.isZero(0)) return Says::nothing;  // as programs write where there is none
  if (std::abs(v.norm() - 1) > kRounded) return Says::no;
  const bool flags = ((v.array() == 0) || (v.array() == 1)).all();
  return flags ? Says::normal_or_flags : Says::normal;
}

// The first of three columns behind x, y, z that are unit vectors in up to a thousand rows spread over the
// file, or empty in less than half of them; 0 if there are none.
std::size_t unit_columns(const Table& table) {
  constexpr std::size_t kRows = 1000;
  const std::size_t columns = table.fields.size(), stride = std::max<std::size_t>(1, table.count / kRows);
  constexpr std::size_t kSure = 100;  // one row in so many, at least, is no flags
  std::vector<std::size_t> normal(columns, 0), unit(columns, 0);
  std::size_t seen = 0;
  std::vector<char> no(columns, 0);
  std::vector<double> values(columns);
  for (std::size_t i = 0; i < table.count; i += stride) {
    const std::string_view row = table.row(i);
    const char* p = row.data();
    for (double& value : values)
      value = parse_real(next_word(p, row.data() + row.size(), table.separators)).value_or(std::nan(""));
    for (std::size_t k = 3; k + 3 <= columns; ++k) {
      const Says says = says_of_normal({values[k], values[k + 1], values[k + 2]});
      normal[k] += std::size_t(says == Says::normal);
      unit[k] += std::size_t(says == Says::normal || says == Says::normal_or_flags);
      no[k] = char(no[k] != 0 || says == Says::no);
    }
    ++seen;
  }
  for (std::size_t k = 3; k + 3 <= columns; ++k)
    if (no[k] == 0 && 2 * unit[k] > seen && kSure * normal[k] >= seen) return k;
  return 0;
}

}  // namespace

Cloud read_xyz(const Source& source, const Context& context) {
  Cloud cloud;
  cloud.format = Format::xyz;
  cloud.encoding = Encoding::ascii;
  TextCursor cursor(source, 0, 0, context);
  std::vector<std::string> names = read_beginning(cursor, cloud);
  cloud.original_header.assign(cursor.all.data(), cursor.at);

  const std::string_view first = peek_line(cursor);
  if (first.empty()) source.fail("line {}: expected points, found the end of the file", cursor.lines + 1);
  const auto words = words_of(first, Separators::space_comma);
  if (words.size() < 3)
    source.fail("line {}: expected at least 3 columns, found {} in {}", cursor.lines + 1, words.size(),
                in_quotes(without_line_end(first)));
  if (has_decimal_commas(first))
    source.fail(
        "line {}: expected decimal points and one kind of separator, found commas between digits in {}",
        cursor.lines + 1, in_quotes(without_line_end(first)));

  if (names.size() != words.size()) {
    // Not this file's columns: an ordinary comment after all.
    names.clear();
    cloud.xyz_style.names.reset();
  }
  const auto names_line =
      std::find_if(cloud.notes.begin(), cloud.notes.end(), [](const Note& n) { return n.element == 1; });
  if (names_line != cloud.notes.end()) {
    if (!names.empty())
      cloud.notes.erase(names_line);
    else
      names_line->element = 0;
  }
  Table table;
  table.name = "vertex";
  table.separators = Separators::space_comma;
  for (std::size_t k = 0; k < words.size(); ++k) {
    std::string name = k < 3 ? std::string(1, char('x' + char(k))) : fmt::format("column_{}", k + 1);
    if (!names.empty()) name = names[k];
    table.fields.push_back({std::move(name), Scalar::float64});
  }
  count_text_rows(table, cursor);
  read_text_rows(table, cursor, context);
  if (const std::size_t k = names.empty() ? unit_columns(table) : 0; k > 0)
    for (std::size_t axis = 0; axis < 3; ++axis) table.fields[k + axis].name = kPlyNormal[axis];
  cloud.tail = cursor.rest();
  cloud.elements.push_back(std::move(table));
  find_coordinates(cloud, source, context);
  cloud.width = cloud.size();
  cloud.original_canonical = xyz_header(cloud);
  return cloud;
}

std::string xyz_header(const Cloud& cloud) {
  std::string out;
  for (const Note& note : cloud.notes) out += note.line + cloud.newline;
  if (cloud.xyz_style.names) {
    out += *cloud.xyz_style.names;
    bool first = true;
    for (const Field& f : cloud.points().fields) {
      if (!first) out += cloud.xyz_style.separator;
      first = false;
      out += f.name;
    }
    out += cloud.newline;
  }
  if (cloud.xyz_style.counted) out += fmt::format("{}{}", cloud.size(), cloud.newline);
  return out;
}

void write_xyz(const Cloud& cloud, Sink& sink, const Context& context) {
  const std::string header = xyz_header(cloud);
  sink.write(header == cloud.original_canonical ? cloud.original_header : header);
  write_text_rows(cloud.points(), sink, context);
  sink.write(cloud.tail);
}

}  // namespace rfsmooth::pipeline::io
