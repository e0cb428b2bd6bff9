#include "pipeline/io/detect.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/formats/off.h"
#include "pipeline/io/table/text.h"

namespace rfsmooth::pipeline::io {
namespace {

bool is_pcd_word(std::string_view word) {
  return word == "VERSION" || word == "FIELDS" || word == "COLUMNS" || word == "SIZE" || word == "TYPE";
}

}  // namespace

Format detect_format(const Source& source, const Context& context) {
  if (source.size() == 0) source.fail("byte 0: expected a PLY, PCD, XYZ or OFF file, found an empty file");
  HeaderLines lines(source, context);
  while (!lines.at_end()) {
    const std::string_view line = lines.next("a point");
    if (lines.line() == 1 && line == "ply") return Format::ply;
    if (line.substr(0, 6) == "# .PCD") return Format::pcd;
    const char* p = line.data();
    const char* end = p + line.size();
    const std::string_view word = next_word(p, end, Separators::space);
    if (is_off_word(word)) return Format::off;
    if (is_pcd_word(word)) return Format::pcd;
    // Words of text hold no control characters; anything else is not an XYZ file either.
    if (std::any_of(line.begin(), line.end(),
                    [](char c) { return (c >= 0 && c < ' ' && c != '\t' && c != '\r') || c == 127; }))
      lines.fail(fmt::format("expected a PLY, PCD, XYZ or OFF file, found {}", in_quotes(line)));
    if (!word.empty() && word.front() != '#') return Format::xyz;
  }
  source.fail("expected points, found comments and blank lines only");
}

}  // namespace rfsmooth::pipeline::io
