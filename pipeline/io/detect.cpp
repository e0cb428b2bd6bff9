#include "pipeline/io/detect.h"

#include <algorithm>

#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/formats/off.h"
#include "pipeline/io/formats/ply.h"
#include "pipeline/io/other_formats.h"
#include "pipeline/io/table/text.h"

namespace rfsmooth::pipeline::io {
namespace {

bool is_pcd_word(std::string_view word) {
  return word == "VERSION" || word == "FIELDS" || word == "COLUMNS" || word == "SIZE" || word == "TYPE";
}

// What the first line of an OBJ file that is not a comment begins with.
bool is_obj_word(std::string_view word) {
  return word == "v" || word == "vn" || word == "vt" || word == "mtllib" || word == "o";
}

void refuse(const Source& source, const OtherFormat* other) {
  if (other != nullptr) source.fail("{} is not read; {}", other->name, other->advice);
}

// Refuses unknown bytes in a file that is called as somebody else's are.
void refuse_other_name(const Source& source) {
  refuse(source, other_format_of_extension(source.name()));
}

// Refuses a text that begins as an OBJ file does, or is called as somebody else's texts are. What is called
// as files of bytes are (.dat, .bin) may be text columns all the same.
void refuse_other_text(const Source& source, std::string_view word) {
  const OtherFormat* const other = other_format_of_extension(is_obj_word(word) ? "any.obj" : source.name());
  if (other != nullptr && other->text) refuse(source, other);
}

}  // namespace

Format detect_format(const Source& source, const Context& context) {
  if (source.size() == 0)
    source.fail("byte 0: expected a PLY, PCD, XYZ, OFF or LAS file, found an empty file");
  constexpr std::uint64_t kLongestMagic = 16;
  const Bytes first = source.read(0, std::size_t(std::min(source.size(), kLongestMagic)), context);
  const std::string_view start(first.data(), first.size());
  if (start.substr(0, 4) == "LASF") return Format::las;
  refuse(source, other_format_of_bytes(start));
  HeaderLines lines(source, context);
  while (!lines.at_end()) {
    const std::string_view line = lines.next("a point");
    if (is_ply_line(line)) return Format::ply;
    if (line.substr(0, 6) == "# .PCD") return Format::pcd;
    std::string_view rest = line;
    const std::string_view word = next_word(rest);
    if (is_off_word(word)) return Format::off;
    if (is_pcd_word(word)) return Format::pcd;
    // Words of text hold no control characters; anything else is not an XYZ file either.
    if (std::any_of(line.begin(), line.end(),
                    [](char c) { return (c >= 0 && c < ' ' && c != '\t' && c != '\r') || c == 127; })) {
      refuse_other_name(source);
      lines.fail("expected a PLY, PCD, XYZ, OFF or LAS file, found {}", in_quotes(line));
    }
    if (word.empty() || word.front() == '#') continue;
    refuse_other_text(source, word);
    return Format::xyz;
  }
  refuse_other_name(source);
  source.fail("expected points, found comments and blank lines only");
}

}  // namespace rfsmooth::pipeline::io
