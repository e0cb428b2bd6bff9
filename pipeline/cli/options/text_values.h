/// Values as people type them, read strictly: the whole text must be the value ("1.5abc", "nan", "" are
/// errors), and numbers print with as many digits as bring back the same bits.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include <rfsmooth/options.h>

namespace rfsmooth::cli {

/// The finite number that is the whole of `text`; nothing otherwise.
std::optional<double> read_number(std::string_view text);

/// The whole number that is the whole of `text`; nothing otherwise or out of int's range.
std::optional<int> read_integer(std::string_view text);

/// "0.02" (world units) or "2x" (times the mean spacing); nothing otherwise.
std::optional<Length> read_length(std::string_view text);

/// The three finite numbers "x,y,z"; nothing otherwise.
std::optional<Eigen::Vector3d> read_point(std::string_view text);

std::string to_text(double value);
std::string to_text(const Length& value);
std::string to_text(const Eigen::Vector3d& value);

/// A message of the library as the command says it: options, which it puts between backticks, as they are
/// typed ("`alpha`" becomes "--alpha").
std::string with_dashes(const std::string& message);

}  // namespace rfsmooth::cli
