/// Numbers and words of ascii files: strict parsing, and printing that round-trips.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/io/table/field.h"

namespace rfsmooth::pipeline::io {

/// What stands between the values of a line.
enum class Separators {
  space,        ///< blanks and tabs (PLY, PCD, OFF)
  space_comma,  ///< also ',' and ';', several of them as one (XYZ whose rows mix them)
  comma,        ///< ',' between cells, which may be empty or in quotes (XYZ, as are the next two)
  semicolon,    ///< ';' between cells
  tab,          ///< a tab between cells
};

/// What stands between cells; 0 where the values are words instead, none of which is empty.
inline char cell_separator(Separators s) {
  return s == Separators::comma ? ',' : s == Separators::semicolon ? ';' : s == Separators::tab ? '\t' : '\0';
}

/// Takes the first cell off `rest`, with its separator. Returns it without blanks and quotes around it; may
/// be empty.
std::string_view next_cell(std::string_view& rest, char separator);

/// Whether c stands between two values.
inline bool is_separator(char c, Separators s) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f' ||
         (s == Separators::space_comma && (c == ',' || c == ';'));
}

/// Without blanks, tabs and line ends around it.
std::string_view without_blanks(std::string_view text);

/// A cell without the quotes around it, and without blanks inside these.
std::string_view without_quotes(std::string_view cell);

/// Takes the first word off `rest`, with what is before it; returns an empty one, at its end, if there is
/// none. Of a row of cells: the first cell.
inline std::string_view next_word(std::string_view& rest, Separators s = Separators::space) {
  if (const char separator = cell_separator(s); separator != '\0') return next_cell(rest, separator);
  const char* p = rest.data();
  const char* const end = p + rest.size();
  while (p != end && is_separator(*p, s)) ++p;
  const char* const first = p;
  while (p != end && !is_separator(*p, s)) ++p;
  rest = {p, std::size_t(end - p)};
  return {first, std::size_t(p - first)};
}

/// All words of a line, or all of its cells.
std::vector<std::string_view> words_of(std::string_view line, Separators s = Separators::space);

/// The same with the quotes around cells.
std::vector<std::string_view> words_as_written(std::string_view line, Separators s);

/// A number of rows and the like: digits only. None if it is anything else, or too large.
std::optional<std::uint64_t> parse_count(std::string_view word);

/// Parses a real number: decimal or scientific, optional sign, nan and inf as spelled by C, C++ and Windows.
/// Independent of the locale. Values beyond the range of double give infinity or zero. None if it is anything
/// else.
std::optional<double> parse_real(std::string_view word);

/// The value of a word that is_value accepts; of an empty cell: NaN.
double value_of(std::string_view word);

/// Parses a whole number in the range of the integer `type`; "3.0" and "1e3" are accepted. Returns its bits:
/// two's complement, in the low bytes.
std::optional<std::uint64_t> parse_integer(std::string_view word, Scalar type);

/// Whether `word` can be a value of `type`.
bool is_value(std::string_view word, Scalar type);

/// Stores the value of `word` (which must satisfy is_value, or be an empty cell of a float) at `p` as `type`,
/// floats rounded to nearest.
void store_text(std::string_view word, Scalar type, char* p);

/// Appends the fewest digits that give `value` back when read as `type`; "nan", "inf", "-inf".
void append_number(std::string& out, double value, Scalar type);

/// Appends the value stored at `p` (little-endian) in the same way; 64-bit integers exactly.
void append_stored(std::string& out, const char* p, Scalar type);

/// Whether a float32 represents all digits of the real number `word`.
bool fits_float32(std::string_view word);

}  // namespace rfsmooth::pipeline::io
