#include "pipeline/io/table/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace rfsmooth::pipeline::io {
namespace {

// What Windows runtimes print for non-finite numbers: 1.#INF, 1.#QNAN, filled up with zeros; from_chars knows
// "nan", "inf" and "nan(...)".
std::optional<double> parse_windows(std::string_view word) {
  const bool negative = !word.empty() && word.front() == '-';
  if (negative) word.remove_prefix(1);
  const auto take = [&](std::string_view prefix) {
    if (word.substr(0, prefix.size()) != prefix) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  if (!take("1.#")) return std::nullopt;
  const bool infinite = take("INF");
  if (!infinite && !take("QNAN") && !take("SNAN") && !take("IND")) return std::nullopt;
  if (word.find_first_not_of('0') != std::string_view::npos) return std::nullopt;
  if (!infinite) return std::numeric_limits<double>::quiet_NaN();
  return negative ? -HUGE_VAL : HUGE_VAL;
}

template <class T>
std::optional<std::uint64_t> integer_as(std::string_view word) {
  const char* end = word.data() + word.size();
  T value{};
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc{} && stop == end) return std::uint64_t(value);
  if (error == std::errc::result_out_of_range) return std::nullopt;
  // Some writers print whole numbers as reals.
  const auto real = parse_real(word);
  if (!real || *real != std::floor(*real) || std::fabs(*real) > 9007199254740992.0) return std::nullopt;
  if (*real < double(std::numeric_limits<T>::min()) || *real > double(std::numeric_limits<T>::max()))
    return std::nullopt;
  return std::uint64_t(T(*real));
}

template <class T>
void append_real(std::string& out, T value) {
  if (std::isnan(value)) {
    out += "nan";
    return;
  }
  char buffer[64];
  const T size = std::fabs(value);
  // Plain digits where a person would write them; std::to_chars alone prefers 1e+06 to 1000000.
  const bool plain = size == 0 || (size >= T(1e-5) && size < T(1e16));
  const auto result = plain ? std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed)
                            : std::to_chars(buffer, buffer + sizeof buffer, value);
  out.append(buffer, result.ptr);
}

template <class T>
void append_whole(std::string& out, T value) {
  char buffer[32];
  out.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

int significant_digits(std::string_view word) {
  int digits = 0;
  for (const char c : word) {
    if (c == 'e' || c == 'E') break;
    if (c < '0' || c > '9') continue;
    if (digits > 0 || c != '0') ++digits;
  }
  return digits;
}

// Where the first separator is that is not between quotes, or the end.
std::size_t end_of_cell(std::string_view text, char separator) {
  bool quoted = false;
  std::size_t at = 0;
  for (; at < text.size() && (quoted || text[at] != separator); ++at) quoted = quoted != (text[at] == '"');
  return at;
}

// Takes the first cell off `rest`, with its separator; returns it with its quotes.
std::string_view next_as_written(std::string_view& rest, char separator) {
  const std::size_t size = end_of_cell(rest, separator);
  const std::string_view cell = without_blanks(rest.substr(0, size));
  rest.remove_prefix(std::min(size + 1, rest.size()));
  return cell;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (bool more = true; more;) {
    more = end_of_cell(line, separator) < line.size();
    cells.push_back(next_as_written(line, separator));
  }
  return cells;
}

}  // namespace

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && is_separator(text.front(), Separators::space)) text.remove_prefix(1);
  while (!text.empty() && is_separator(text.back(), Separators::space)) text.remove_suffix(1);
  return text;
}

std::string_view without_quotes(std::string_view cell) {
  if (cell.size() < 2 || cell.front() != '"' || cell.back() != '"') return cell;
  return without_blanks(cell.substr(1, cell.size() - 2));
}

std::string_view next_cell(std::string_view& rest, char separator) {
  return without_quotes(next_as_written(rest, separator));
}

std::vector<std::string_view> words_of(std::string_view line, Separators s) {
  std::vector<std::string_view> words = words_as_written(line, s);
  if (cell_separator(s) != '\0') std::transform(words.begin(), words.end(), words.begin(), without_quotes);
  return words;
}

std::vector<std::string_view> words_as_written(std::string_view line, Separators s) {
  if (const char separator = cell_separator(s); separator != '\0') return cells_of(line, separator);
  std::vector<std::string_view> words;
  for (std::string_view word = next_word(line, s); !word.empty(); word = next_word(line, s))
    words.push_back(word);
  return words;
}

std::optional<std::uint64_t> parse_count(std::string_view word) {
  std::uint64_t value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc{} || stop != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<double> parse_real(std::string_view word) {
  if (!word.empty() && word.front() == '+') {
    word.remove_prefix(1);
    if (!word.empty() && word.front() == '-') return std::nullopt;
  }
  const char* end = word.data() + word.size();
  double value = 0;
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc{} && stop == end) return value;
  if (error == std::errc::result_out_of_range && stop == end) {
    // from_chars does not say which way: an exponent below zero can only be too small here.
    const bool negative = word.front() == '-';
    const std::size_t e = word.find_first_of("eE");
    const bool small =
        e != std::string_view::npos ? word.substr(e + 1, 1) == "-" : word.find('.') <= (negative ? 2u : 1u);
    return std::copysign(small ? 0.0 : HUGE_VAL, negative ? -1.0 : 1.0);
  }
  return parse_windows(word);
}

double value_of(std::string_view word) {
  return word.empty() ? std::numeric_limits<double>::quiet_NaN() : parse_real(word).value();
}

std::optional<std::uint64_t> parse_integer(std::string_view word, Scalar type) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  return with_type(type, [word](auto value) -> std::optional<std::uint64_t> {
    if constexpr (std::numeric_limits<decltype(value)>::is_integer)
      return integer_as<decltype(value)>(word);
    else
      throw std::invalid_argument("parse_integer: not an integer type");
  });
}

bool is_value(std::string_view word, Scalar type) {
  return is_float(type) ? parse_real(word).has_value() : parse_integer(word, type).has_value();
}

void store_text(std::string_view word, Scalar type, char* p) {
  if (is_float(type)) {
    store(type, p, value_of(word));
  } else {
    const std::uint64_t bits = parse_integer(word, type).value();
    std::memcpy(p, &bits, size_of(type));
  }
}

void append_number(std::string& out, double value, Scalar type) {
  if (type == Scalar::float64) {
    append_real(out, value);
  } else {
    char stored[8];
    store(type, stored, value);
    append_stored(out, stored, type);
  }
}

void append_stored(std::string& out, const char* p, Scalar type) {
  with_type(type, [&out, p](auto value) {
    std::memcpy(&value, p, sizeof value);
    if constexpr (std::numeric_limits<decltype(value)>::is_integer)
      append_whole(out, value);
    else
      append_real(out, value);
  });
}

bool fits_float32(std::string_view word) {
  const double value = parse_real(word).value();
  const float nearest = float(value);
  if (double(nearest) == value || !(value == value)) return true;
  // "0.1" is a name of a float although no float equals 0.1: that float, at as many digits, reads the same.
  const int digits = significant_digits(word);
  char buffer[64];
  if (!std::isfinite(nearest) || digits == 0 || digits > 40) return false;
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, double(nearest),
                                    std::chars_format::scientific, digits - 1);
  return parse_real({buffer, std::size_t(result.ptr - buffer)}) == value;
}

}  // namespace rfsmooth::pipeline::io
