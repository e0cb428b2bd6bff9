#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/io/formats/pcd.h"

namespace rfsmooth::pipeline::io {
namespace {

constexpr std::string_view kFirstLine = "# .PCD v0.7 - Point Cloud Data file format";

// No sensor has fields of so many values; products of counts stay far from the range of 64 bits.
constexpr std::uint64_t kMostCount = std::uint64_t{1} << 24;

std::uint64_t count_of(std::string_view key, std::string_view word, const HeaderLines& lines) {
  const auto value = parse_count(word);
  if (!value) lines.fail("expected a whole number after {}, found {}", key, in_quotes(word));
  return *value;
}

char type_letter(Scalar type) {
  if (is_float(type)) return 'F';
  return with_type(type, [](auto value) { return std::is_signed_v<decltype(value)>; }) ? 'I' : 'U';
}

Scalar parse_type(std::string_view letter, std::uint64_t size, const HeaderLines& lines) {
  for (const Scalar type : kScalars)
    if (letter == std::string(1, type_letter(type)) && size == size_of(type)) return type;
  lines.fail("expected TYPE I or U of SIZE 1, 2, 4 or 8, or F of SIZE 4 or 8, found TYPE {} of SIZE {}",
             in_quotes(letter), size);
}

// The header's lines by keyword, before they are put together.
struct Entries {
  std::vector<std::string> fields, size, type, count, viewpoint;
  std::optional<std::uint64_t> width, height, points;
  std::string data;
};

std::vector<std::string> strings(const std::vector<std::string_view>& words) {
  return {words.begin() + 1, words.end()};
}

Entries read_entries(HeaderLines& lines, Cloud& cloud) {
  Entries e;
  for (;;) {
    const std::string_view line = lines.next("the DATA line");
    if (lines.line() == 1 && lines.crlf()) cloud.newline = "\r\n";
    const auto words = words_of(line);
    if (words.empty()) continue;
    const std::string_view key = words[0];
    const std::string_view first = words.size() > 1 ? words[1] : std::string_view{};
    if (key.front() == '#') {
      if (line.substr(0, 6) != "# .PCD") cloud.notes.push_back({std::string(line)});
    } else if (key == "VERSION") {
      // Any: what the versions differ in shows in the lines that are there.
    } else if (key == "FIELDS" || key == "COLUMNS") {
      if (!e.fields.empty()) lines.fail("expected one FIELDS line, found a second");
      e.fields = strings(words);
    } else if (key == "SIZE") {
      e.size = strings(words);
    } else if (key == "TYPE") {
      e.type = strings(words);
    } else if (key == "COUNT") {
      e.count = strings(words);
    } else if (key == "WIDTH") {
      e.width = count_of(key, first, lines);
    } else if (key == "HEIGHT") {
      e.height = count_of(key, first, lines);
    } else if (key == "POINTS") {
      e.points = count_of(key, first, lines);
    } else if (key == "VIEWPOINT") {
      e.viewpoint = strings(words);
      if (e.viewpoint.size() != 7)
        lines.fail("expected 7 numbers after VIEWPOINT, found {}", e.viewpoint.size());
      for (const std::string& word : e.viewpoint)
        if (!parse_real(word)) lines.fail("expected 7 numbers after VIEWPOINT, found {}", in_quotes(word));
    } else if (key == "DATA") {
      e.data = first;
      return e;
    } else {
      lines.fail(
          "expected VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS or DATA, found {}",
          in_quotes(key));
    }
  }
}

Table points_of(const Entries& e, const HeaderLines& lines) {
  const std::size_t n = e.fields.size();
  if (n == 0) lines.fail("expected a FIELDS line with names before DATA, found none");
  const auto need = [&](std::string_view key, const std::vector<std::string>& words) {
    if (words.size() != n)
      lines.fail("expected {} after {}, one per field, found {}", counted(n, "word"), key, words.size());
  };
  need("SIZE", e.size);
  need("TYPE", e.type);
  if (!e.count.empty()) need("COUNT", e.count);
  Table table;
  table.name = "vertex";
  for (std::size_t f = 0; f < n; ++f) {
    Field field{e.fields[f], parse_type(e.type[f], count_of("SIZE", e.size[f], lines), lines)};
    if (!e.count.empty()) field.count = std::size_t(count_of("COUNT", e.count[f], lines));
    if (field.count == 0 || field.count > kMostCount)
      lines.fail("expected COUNT from 1 to {} for field {}, found {}", kMostCount, in_quotes(field.name),
                 field.count);
    table.fields.push_back(std::move(field));
  }
  return table;
}

void set_size(Cloud& cloud, const Entries& e, const HeaderLines& lines) {
  if (!e.points && !e.width) lines.fail("expected POINTS or WIDTH and HEIGHT before DATA, found neither");
  const std::uint64_t width = e.width ? *e.width : *e.points, height = e.width ? e.height.value_or(1) : 1;
  if (width != 0 && height > std::uint64_t(-1) / width)
    lines.fail("expected WIDTH x HEIGHT points, found {} x {}", width, height);
  if (e.points && *e.points != width * height)
    lines.fail("expected POINTS {} = WIDTH {} x HEIGHT {}, found {}", width * height, width, height,
               *e.points);
  cloud.points().count = width * height;
  cloud.width = width;
  cloud.height = height;
}

}  // namespace

Cloud read_pcd_header(HeaderLines& lines) {
  Cloud cloud;
  cloud.format = Format::pcd;
  const Entries e = read_entries(lines, cloud);
  if (e.data == "ascii") {
    cloud.encoding = Encoding::ascii;
  } else if (e.data == "binary") {
    cloud.encoding = Encoding::binary_little_endian;
  } else if (e.data == "binary_compressed") {
    cloud.encoding = Encoding::binary_compressed;
  } else {
    lines.fail("expected DATA ascii, binary or binary_compressed, found {}", in_quotes(e.data));
  }
  cloud.elements.push_back(points_of(e, lines));
  set_size(cloud, e, lines);
  if (!e.viewpoint.empty()) cloud.viewpoint = fmt::format("{}", fmt::join(e.viewpoint, " "));
  cloud.original_header = lines.text();
  if (cloud.original_header.back() != '\n') cloud.original_header += cloud.newline;  // cut off there
  cloud.original_canonical = pcd_header(cloud, cloud.encoding);
  return cloud;
}

std::string pcd_header(const Cloud& cloud, Encoding encoding) {
  const std::string& newline = cloud.newline;
  std::string fields = "FIELDS", size = "SIZE", type = "TYPE", count = "COUNT";
  for (const Field& f : cloud.points().fields) {
    fields += " " + one_word(f.name);
    size += fmt::format(" {}", size_of(f.type));
    type += fmt::format(" {}", type_letter(f.type));
    count += fmt::format(" {}", f.count);
  }
  std::string out(kFirstLine);
  out += newline;
  for (const Note& note : cloud.notes) out += note.line + newline;
  out += "VERSION 0.7" + newline;
  out += fields + newline + size + newline + type + newline + count + newline;
  out += fmt::format("WIDTH {}{}HEIGHT {}{}", cloud.width, newline, cloud.height, newline);
  out += "VIEWPOINT " + cloud.viewpoint + newline;
  out += fmt::format("POINTS {}{}", cloud.size(), newline);
  out += fmt::format("DATA {}{}", encoding == Encoding::binary_little_endian ? "binary" : name_of(encoding),
                     newline);
  return out;
}

}  // namespace rfsmooth::pipeline::io
