/// Typed values, parsed strictly: the whole text must be the value ("1.5abc", "nan" and "" are errors, for
/// which the parsers return nothing). Numbers are printed with as many digits as restore the same bits.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>
#include <fmt/format.h>

#include <rfsmooth/options.h>

namespace rfsmooth::cli {

/// Parses a finite number.
std::optional<double> read_number(std::string_view text);

/// Parses a whole number in the range of int.
std::optional<int> read_integer(std::string_view text);

/// Parses a number that may end in K, M, G or T, as "8G" and "2.5M": times a thousand, a million, ...
std::optional<double> read_amount(std::string_view text);

/// Parses a count in the range of int, "5000000" or "5M".
std::optional<int> read_count(std::string_view text);

/// Parses "0.02" (world units) or "2x" (times the mean spacing).
std::optional<Length> read_length(std::string_view text);

/// Parses three finite numbers "x,y,z".
std::optional<Eigen::Vector3d> read_point(std::string_view text);

/// A value as it would be typed; of a number the shortest text that reads back as the same.
template <class T>
std::string to_text(const T& value) {
  return fmt::format("{}", value);
}
std::string to_text(const Length& value);
std::string to_text(const Eigen::Vector3d& value);

/// One word as a shell reads it: as it is, or between quotation marks.
std::string shell_quoted(const std::string& word);

/// A message of the library in the command's words: option names between backticks become "--name".
std::string with_dashes(const std::string& message);

}  // namespace rfsmooth::cli
