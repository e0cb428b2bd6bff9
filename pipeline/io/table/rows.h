/// Reads and writes the rows of a table, binary in either byte order or as text.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "pipeline/io/stream/sink.h"
#include "pipeline/io/stream/source.h"
#include "pipeline/io/table/table.h"

namespace rfsmooth::pipeline::io {

/// Walks the binary body of a file.
struct BinaryCursor {
  const Source& source;
  std::uint64_t offset;  ///< next byte to read
  bool big_endian = false;
  Bytes held = {};  ///< the file from `held_from` on, once an element with lists needs it; what is read goes
  std::uint64_t held_from = 0;
};

/// The byte behind the binary rows of a table without lists, whose first is at `offset`. \throw Failure
/// naming the byte, what was expected and what was found, if the file ends before.
std::uint64_t end_of_rows(const Table& table, std::uint64_t offset, const Source& source);

/// Reads table.count rows of table.fields. The promised size is checked against the file before anything is
/// allocated. \throw Failure naming the byte, what was expected and what was found.
void read_binary_rows(Table& table, BinaryCursor& cursor, const Context& context);

/// Walks the text body of a file.
struct TextCursor {
  TextCursor(const Source& from, std::uint64_t offset, std::size_t lines_before, const Context& context);
  const Source& source;
  Bytes all;           ///< the file from the first line of the body on; rows that are read may be taken out
  std::size_t at = 0;  ///< next byte of `all`
  std::size_t lines;   ///< lines of the file before `at`
  std::string_view rest() const { return {all.data() + at, all.size() - at}; }
};

/// Whether a line of a text body holds no values: blank, or a comment ('#' or '//').
bool is_blank_or_comment(std::string_view line);

/// The next line of the body with its line end, empty at the end. Does not move the cursor.
std::string_view peek_line(const TextCursor& cursor);

/// Moves the cursor behind the next line.
void skip_line(TextCursor& cursor);

/// Sets table.count to the number of lines left that hold values.
void count_text_rows(Table& table, const TextCursor& cursor);

/// Reads table.count lines and checks that each holds exactly the values of its fields. Blank lines and
/// comments are kept as interludes. \throw Failure naming the line, what was expected and what was found.
void read_text_rows(Table& table, TextCursor& cursor, const Context& context);

/// Writes the rows as bytes; a text table is converted on the way.
void write_binary_rows(const Table& table, bool big_endian, Sink& sink, const Context& context);
/// Writes the rows as text; a binary table is converted on the way.
void write_text_rows(const Table& table, Sink& sink, const Context& context);
/// Writes tables as text, one behind the other, and then `tail`. The last line of a file may lack its line
/// end; it gets one where something follows it.
void write_text_body(const std::vector<const Table*>& tables, std::string_view tail, Sink& sink,
                     const Context& context);

}  // namespace rfsmooth::pipeline::io
