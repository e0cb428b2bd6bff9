/// One table for every option. An options struct is a plain struct whose `describe` names each field once;
/// help texts, the README's tables, reports and validation are all made by visiting it.
///
///     struct HcOptions {
///       double alpha = 0.0;
///       template <class Self, class Visit>
///       static void describe(Self& self, Visit&& visit) {
///         visit(OptionInfo{"alpha", "weight of the original point", "", 0, 1}, self.alpha);
///       }
///     };
///
/// Field types: bool, int, double, std::string, Length, Eigen::Vector3d (a direction of any length but zero),
/// enumerations, and std::optional of them (empty = chosen from the data). The words of an enumeration are
/// the `choices`: its values are their indices; one whose word is empty cannot be chosen. A string with
/// `choices` is one of them.
///
/// Errors name an option as the table does, between backticks: "`alpha` is 2; it must be between 0 and 1".
/// Thread safe: no state is kept.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/result.h>

namespace rfsmooth {

/// What the tables of `describe` say of an option.
struct OptionInfo {
  std::string_view name;  ///< words joined by '-'
  std::string_view help;  ///< one line: what it means
  std::string_view unit;  ///< "", "steps", "x spacing", "world units or x spacing", ...
  double min = -std::numeric_limits<double>::infinity();  ///< inclusive
  double max = std::numeric_limits<double>::infinity();   ///< inclusive
  std::vector<std::string_view> choices = {};  ///< the word of each value of an enumeration, or of a string
};

/// The table's entry of an enumeration.
inline OptionInfo words(std::string_view name, std::string_view help, std::vector<std::string_view> choices) {
  OptionInfo info{name, help, ""};
  info.choices = std::move(choices);
  return info;
}

/// A length: absolute in world units ("0.02") or a multiple of the mean spacing ("2x").
struct Length {
  double value = 0;
  bool times_spacing = true;
  double resolve(double spacing) const { return times_spacing ? value * spacing : value; }
};

/// Checks every field of `options` against its range; call once at a front door.
/// The error (ErrorCode::usage) names the field, its value and the legal range.
template <class Options>
Result<Done> validate(const Options& options);

namespace detail {
/// What is wrong with the value of that option, if anything.
std::optional<Error> check_range(const OptionInfo& info, double value);
/// The same for a value of an enumeration.
std::optional<Error> check_choice(const OptionInfo& info, std::size_t value);
/// The same for a word; any if there are no choices.
std::optional<Error> check_word(const OptionInfo& info, const std::string& value);
/// The same for a direction.
std::optional<Error> check_direction(const OptionInfo& info, const Eigen::Vector3d& value);

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
  void operator()(const OptionInfo& info, const Eigen::Vector3d& value) {
    note(check_direction(info, value));
  }
  void operator()(const OptionInfo& info, const std::string& value) { note(check_word(info, value)); }
  template <class Enumeration, std::enable_if_t<std::is_enum_v<Enumeration>, int> = 0>
  void operator()(const OptionInfo& info, Enumeration value) {
    note(check_choice(info, std::size_t(value)));
  }
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
