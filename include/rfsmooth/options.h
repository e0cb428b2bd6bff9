/// One table for every option. An options struct is a plain struct whose `describe` names each field once;
/// `--help`, the README's tables, the JSON report, `--config` and validation are all made by visiting it.
///
///     struct HcOptions {
///       double alpha = 0.0;
///       template <class Self, class Visit>
///       static void describe(Self& self, Visit&& visit) {
///         visit(OptionInfo{"alpha", "weight of the original point", "", 0, 1}, self.alpha);
///       }
///     };
///
/// Field types: bool, int, double, std::string, Length, and std::optional of them (empty = "auto": chosen
/// from the data or by the flow). An option with a fixed set of words lists them in `choices`.
/// Thread safe: no state is kept.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <rfsmooth/result.h>

namespace rfsmooth {

/// What the tables of `describe` say of an option.
struct OptionInfo {
  std::string_view name;  ///< long option without the dashes, words joined by '-'
  std::string_view help;  ///< one line: what it means
  std::string_view unit;  ///< "", "steps", "x spacing", "world units or x spacing", ...
  double min = -std::numeric_limits<double>::infinity();  ///< inclusive
  double max = std::numeric_limits<double>::infinity();   ///< inclusive
  std::vector<std::string_view> choices = {};             ///< for words: the legal ones
};

/// A length: absolute in world units ("0.02") or a multiple of the mean spacing ("2x").
struct Length {
  double value = 0;
  bool times_spacing = true;
  double resolve(double spacing) const { return times_spacing ? value * spacing : value; }
};

/// Checks every field of `options` against its range or choices; call once at a front door.
/// The error (ErrorCode::usage) names the field, its value and the legal range.
template <class Options>
Result<Done> validate(const Options& options);

namespace detail {
/// What is wrong with the value of that option, if anything.
std::optional<Error> check_range(const OptionInfo& info, double value);
/// The same for a name.
std::optional<Error> check_choice(const OptionInfo& info, const std::string& value);

/// Visits an option table and keeps the first thing that is wrong.
struct Validator {
  std::optional<Error> error;
  void note(std::optional<Error> e) {
    if (!error) error = std::move(e);
  }
  void operator()(const OptionInfo&, bool) {}
  void operator()(const OptionInfo& info, int value) { note(check_range(info, value)); }
  void operator()(const OptionInfo& info, double value) { note(check_range(info, value)); }
  void operator()(const OptionInfo& info, const Length& value) { note(check_range(info, value.value)); }
  void operator()(const OptionInfo& info, const std::string& value) { note(check_choice(info, value)); }
  template <class T>
  void operator()(const OptionInfo& info, const std::optional<T>& value) {
    if (value) (*this)(info, *value);
  }
};
}  // namespace detail

template <class Options>
Result<Done> validate(const Options& options) {
  detail::Validator validator;
  Options::describe(options, validator);
  if (validator.error) return *validator.error;
  return Done{};
}

}  // namespace rfsmooth
