/// Numbers and words of ascii files: parsing that refuses what is not a number, printing that round-trips.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "pipeline/io/table/field.h"

namespace rfsmooth::pipeline::io {

/// What stands between the values of a line.
enum class Separators {
  space,        ///< blanks and tabs (PLY, PCD, OFF)
  space_comma,  ///< also ',' and ';' (XYZ)
};

/// Whether c stands between two values.
inline bool is_separator(char c, Separators s) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f' ||
         (s == Separators::space_comma && (c == ',' || c == ';'));
}

/// The next word at or after `p`; empty (at `end`) if there is none. Moves `p` behind it.
inline std::string_view next_word(const char*& p, const char* end, Separators s = Separators::space) {
  while (p != end && is_separator(*p, s)) ++p;
  const char* first = p;
  while (p != end && !is_separator(*p, s)) ++p;
  return {first, std::size_t(p - first)};
}

/// A real number: decimal or scientific, optional sign, nan and inf in the spellings of C, C++ and Windows.
/// Too large or too small for double gives infinity or zero. Locale-free. Empty optional if it is anything
/// else.
std::optional<double> parse_real(std::string_view word);

/// A whole number in the range of the integer `type`; "3.0" and "1e3" are accepted.
/// The value's bits, two's complement, little-endian in the low bytes.
std::optional<std::uint64_t> parse_integer(std::string_view word, Scalar type);

/// Whether `word` can be a value of `type`.
bool is_value(std::string_view word, Scalar type);

/// Stores the value of `word` (which must satisfy is_value) at `p` as `type`, floats rounded to nearest.
void store_text(std::string_view word, Scalar type, char* p);

/// Appends the fewest digits that give `value` back when read as `type`; "nan", "inf", "-inf".
void append_number(std::string& out, double value, Scalar type);

/// Appends the value at `p` (little-endian) likewise; 64-bit integers exactly.
void append_stored(std::string& out, const char* p, Scalar type);

/// Whether a float32 holds all that `word`, a real number, says: its digits are those of some float.
bool fits_float32(std::string_view word);

}  // namespace rfsmooth::pipeline::io
