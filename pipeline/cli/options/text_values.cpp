#include "pipeline/cli/options/text_values.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <regex>

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
  return *value + 0.0;  // without the sign of a zero
}

std::optional<int> read_integer(std::string_view text) {
  return read_whole<int>(text);
}

std::optional<double> read_amount(std::string_view text) {
  constexpr std::string_view kUnits = "KMGT";
  const std::size_t unit = text.empty() ? kUnits.npos : kUnits.find(text.back());
  if (unit == kUnits.npos) return read_number(text);
  const auto value = read_number(text.substr(0, text.size() - 1));
  if (!value) return std::nullopt;
  return *value * std::pow(1e3, double(unit + 1));
}

std::optional<int> read_count(std::string_view text) {
  const auto amount = read_amount(text);
  if (!amount || *amount != std::floor(*amount)) return std::nullopt;
  if (std::abs(*amount) > std::numeric_limits<int>::max()) return std::nullopt;
  return int(*amount);
}

std::optional<Length> read_length(std::string_view text) {
  const bool times_spacing = !text.empty() && text.back() == 'x';
  const auto value = read_number(times_spacing ? text.substr(0, text.size() - 1) : text);
  if (!value) return std::nullopt;
  return Length{*value, times_spacing};
}

std::optional<Eigen::Vector3d> read_point(std::string_view text) {
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t comma = text.find(',');
    const auto value = read_number(text.substr(0, comma));
    if (!value || (comma == text.npos) != (axis == 2)) return std::nullopt;
    point[axis] = *value;
    text.remove_prefix(axis == 2 ? 0 : comma + 1);
  }
  return point;
}

std::string to_text(const Length& value) {
  return fmt::format("{}{}", value.value, value.times_spacing ? "x" : "");
}

std::string to_text(const Eigen::Vector3d& value) {
  return fmt::format("{},{},{}", value.x(), value.y(), value.z());
}

std::string shell_quoted(const std::string& word) {
  static const std::regex kPlain("[A-Za-z0-9_./:=,@%+-]+");
  if (std::regex_match(word, kPlain)) return word;
  return '\'' + std::regex_replace(word, std::regex("'"), "'\\''") + '\'';
}

std::string with_dashes(const std::string& message) {
  static const std::regex option("`([a-z-]+)`");
  return std::regex_replace(message, option, "--$1");
}

}  // namespace rfsmooth::cli
