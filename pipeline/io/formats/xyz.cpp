#include "pipeline/io/formats/xyz.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/formats/ply.h"
#include "pipeline/io/point_fields.h"
#include "pipeline/io/table/rows.h"

namespace rfsmooth::pipeline::io {
namespace {

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

// What parts the columns, by the first row: cells where they are numbers or empty, else words.
Separators separators_of(std::string_view row) {
  for (const Separators s : {Separators::semicolon, Separators::comma, Separators::tab}) {
    const auto cells = words_of(row, s);
    if (cells.size() > 1 && std::all_of(cells.begin(), cells.end(), [](std::string_view cell) {
          return cell.empty() || parse_real(cell).has_value();
        }))
      return s;
  }
  return Separators::space_comma;
}

// How many the first row has: at least three.
std::size_t count_columns(const TextCursor& cursor, Separators separators) {
  const std::string_view row = peek_line(cursor);
  const std::string_view shown = row.substr(0, row.find_first_of("\r\n"));
  const std::size_t line = cursor.lines + 1;
  if (row.empty()) cursor.source.fail("line {}: expected points, found the end of the file", line);
  const auto words = words_of(row, separators);
  if (words.size() < 3)
    cursor.source.fail("line {}: expected at least 3 columns, found {} in {}", line, words.size(),
                       in_quotes(shown));
  if (std::none_of(words.begin(), words.end(), [](auto word) { return word.empty() || parse_real(word); }))
    cursor.source.fail(
        "line {}: expected numbers, or names with x, y and z among them, found {}; call the coordinates so",
        line, in_quotes(shown));
  if (has_decimal_commas(row))
    cursor.source.fail(
        "line {}: expected decimal points and one kind of separator, found commas between digits in {}", line,
        in_quotes(shown));
  return words.size();
}

std::vector<Field> fields_of(const std::vector<std::string>& names, std::size_t columns) {
  std::vector<Field> fields;
  for (std::size_t k = 0; k < columns; ++k) {
    std::string name = k < names.size() ? name_in_cell(names[k]) : "";
    if (name.empty())
      name = names.empty() && k < 3 ? std::string(1, char('x' + char(k))) : fmt::format("column_{}", k + 1);
    fields.push_back({std::move(name), Scalar::float64});
  }
  return fields;
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
    std::string_view row = table.row(i);
    for (double& value : values) value = parse_real(next_word(row, table.separators)).value_or(std::nan(""));
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
  const std::vector<XyzNames> beginning = read_xyz_beginning(cursor, cloud);
  cloud.original_header.assign(cursor.all.data(), cursor.at);
  Table table;
  table.name = "vertex";
  table.separators = separators_of(peek_line(cursor));
  const std::size_t columns = count_columns(cursor, table.separators);
  const auto names = take_xyz_names(beginning, columns, table.separators, source, cloud);
  table.fields = fields_of(names, columns);
  count_text_rows(table, cursor);
  read_text_rows(table, cursor, context);
  if (const auto promised = cloud.xyz_style.counted; promised && *promised != table.count)
    source.fail("line {}: expected {} in all, as a line before the first one says, found {}; {}",
                cursor.lines, counted(*promised, "point"), table.count,
                table.count < *promised ? "the file is cut off, or mend that number" : "mend that number");
  if (const std::size_t k = names.empty() ? unit_columns(table) : 0; k > 0)
    for (std::size_t axis = 0; axis < 3; ++axis) table.fields[k + axis].name = kPlyNormal[axis];
  cloud.tail = cursor.rest();
  cloud.elements.push_back(std::move(table));
  if (const auto axes = xyz_coordinates(names))
    cloud.xyz = *axes;
  else
    find_coordinates(cloud, source, context);
  cloud.width = cloud.size();
  cloud.original_canonical = xyz_header(cloud);
  return cloud;
}

void write_xyz(const Cloud& cloud, Sink& sink, const Context& context) {
  sink.write(cloud.header(xyz_header(cloud)));
  write_text_rows(cloud.points(), sink, context);
  sink.write(cloud.tail);
}

}  // namespace rfsmooth::pipeline::io
