#include "pipeline/cli/options/text_values.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace rfsmooth::cli {

namespace {

template <class T>
std::optional<T> read_whole(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> read_number(std::string_view text) {
  const auto value = read_whole<double>(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<int> read_integer(std::string_view text) {
  return read_whole<int>(text);
}

std::optional<Length> read_length(std::string_view text) {
  const bool times_spacing = !text.empty() && text.back() == 'x';
  const auto value = read_number(times_spacing ? text.substr(0, text.size() - 1) : text);
  if (!value) return std::nullopt;
  return Length{*value, times_spacing};
}

std::optional<std::array<double, 3>> read_three(std::string_view text) {
  std::array<double, 3> values{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t comma = text.find(',');
    const auto value = read_number(text.substr(0, comma));
    if (!value || (comma == std::string_view::npos) != (k == 2)) return std::nullopt;
    values[k] = *value;
    text.remove_prefix(k == 2 ? text.size() : comma + 1);
  }
  return values;
}

std::string to_text(double value) {
  return fmt::format("{}", value);  // shortest text that reads back as the same double
}

std::string to_text(const Length& value) {
  return to_text(value.value) + (value.times_spacing ? "x" : "");
}

}  // namespace rfsmooth::cli
