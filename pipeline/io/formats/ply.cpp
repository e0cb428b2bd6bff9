#include "pipeline/io/formats/ply.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/io/table/rows.h"

namespace rfsmooth::pipeline::io {

void find_vertex(Cloud& cloud, const Source& source) {
  std::string others;
  for (cloud.vertex = 0; cloud.vertex < cloud.elements.size(); ++cloud.vertex) {
    const std::string& name = cloud.elements[cloud.vertex].name;
    if (name == "vertex") return;
    others += (others.empty() ? "" : ", ") + in_quotes(name);
  }
  source.fail("expected an element 'vertex', found {}", others.empty() ? "no element" : others);
}

void find_coordinates(Cloud& cloud, const Source& source, const Context& context) {
  const std::vector<Field>& fields = cloud.points().fields;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t best = fields.size();
    std::size_t same = 0;
    for (const char first : {'x', 'X'}) {
      const std::string name(1, char(first + char(axis)));
      for (std::size_t f = 0; f < fields.size(); ++f) {
        if (fields[f].name != name || !fields[f].is_plain()) continue;
        if (best == fields.size()) best = f;
        if (fields[best].name == name) ++same;
      }
    }
    if (best == fields.size()) {
      std::string there;
      for (const Field& f : fields)
        there += (there.empty() ? "" : ", ") + in_quotes(f.name) +
                 (f.is_list()    ? " (a list)"
                  : f.is_plain() ? ""
                                 : " (several values)");
      source.fail("expected the coordinate '{}' among the points' fields, found {}", char('x' + char(axis)),
                  there.empty() ? "none" : there);
    }
    if (same > 1)
      context.warn(fmt::format("{}: {} fields are called '{}'; the first is the coordinate", source.name(),
                               same, fields[best].name));
    cloud.xyz[axis] = best;
  }
}

void warn_of_tail(const Cloud& cloud, const Source& source, const Context& context) {
  std::string_view rest = cloud.tail;
  while (cloud.encoding == Encoding::ascii && !rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    if (!is_blank_or_comment(line)) break;
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  }
  if (rest.find_first_not_of(" \t\r\n") != std::string_view::npos)
    context.warn(fmt::format("{}: {} behind the last row that the header counts", source.name(),
                             counted(cloud.tail.size(), "byte")));
}

Cloud read_ply(const Source& source, const Context& context) {
  HeaderLines lines(source, context);
  Cloud cloud = read_ply_header(lines);
  find_vertex(cloud, source);
  find_coordinates(cloud, source, context);

  if (cloud.encoding == Encoding::ascii) {
    TextCursor cursor(source, lines.offset(), lines.line(), context);
    for (Table& table : cloud.elements) read_text_rows(table, cursor, context);
    cloud.tail = cursor.rest();
  } else {
    BinaryCursor cursor{source, lines.offset(), cloud.encoding == Encoding::binary_big_endian};
    for (Table& table : cloud.elements) read_binary_rows(table, cursor, context);
    const Bytes rest = source.read(cursor.offset, std::size_t(source.size() - cursor.offset), context);
    cloud.tail.assign(rest.data(), rest.size());
  }
  warn_of_tail(cloud, source, context);
  cloud.width = cloud.size();
  return cloud;
}

void write_ply(const Cloud& cloud, Encoding encoding, Sink& sink, const Context& context) {
  sink.write(cloud.header(ply_header(cloud, encoding)));
  const std::string_view tail = encoding == cloud.encoding ? cloud.tail : std::string_view();
  if (encoding == Encoding::ascii) {
    std::vector<const Table*> tables;
    for (const Table& table : cloud.elements) tables.push_back(&table);
    return write_text_body(tables, tail, sink, context);
  }
  for (const Table& table : cloud.elements) {
    context.check_stop();
    write_binary_rows(table, encoding == Encoding::binary_big_endian, sink, context);
  }
  sink.write(tail);
}

}  // namespace rfsmooth::pipeline::io
