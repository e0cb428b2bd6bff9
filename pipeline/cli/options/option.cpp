#include "pipeline/cli/options/option.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/options/suggest.h"
#include "pipeline/cli/options/text_values.h"

namespace rfsmooth::cli {

namespace {

void need(const std::optional<Error>& error) {
  if (error) throw Failure(*error);
}

template <class T>
constexpr ValueKind kind_of() {
  if constexpr (std::is_same_v<T, bool>) return ValueKind::flag;
  if constexpr (std::is_same_v<T, int>) return ValueKind::integer;
  if constexpr (std::is_same_v<T, double>) return ValueKind::number;
  if constexpr (std::is_same_v<T, Length>) return ValueKind::length;
  return ValueKind::word;
}

/// "--alpha is 'x'; it must be WHAT", with "or 'auto'" where auto is legal.
[[noreturn]] void refuse_value(const CommandOption& option, const std::string& text, const char* what) {
  fail(ErrorCode::usage, "--{} is '{}'; it must be {}{}", option.name, text, what,
       option.optional ? " or 'auto'" : "");
}

/// Reads `text` strictly as a T. `info` gives the legal range.
template <class T>
T parse_as(const CommandOption& option, const OptionInfo& info, const std::string& text) {
  if constexpr (std::is_same_v<T, bool>) {
    if (text != "true" && text != "false") refuse_value(option, text, "true or false");
    return text == "true";
  } else if constexpr (std::is_same_v<T, int>) {
    const bool large = info.unit == "points";
    const auto value = large ? read_count(text) : read_integer(text);
    if (!value) refuse_value(option, text, large ? "a whole number such as 5000000 or 5M" : "a whole number");
    need(rfsmooth::detail::check_range(info, *value));
    return *value;
  } else if constexpr (std::is_same_v<T, double>) {
    const auto value = read_number(text);
    if (!value) refuse_value(option, text, "a number");
    need(rfsmooth::detail::check_range(info, *value));
    return *value;
  } else if constexpr (std::is_same_v<T, Length>) {
    const auto value = read_length(text);
    if (!value) refuse_value(option, text, "a length such as 0.02 (world units) or 2x (times the spacing)");
    need(rfsmooth::detail::check_range(info, value->value));
    return *value;
  } else if constexpr (std::is_same_v<T, Eigen::Vector3d>) {
    const auto value = read_point(text);
    if (!value || value->isZero(0)) refuse_value(option, text, "three numbers x,y,z, not all zero,");
    return *value;
  } else {
    if (option.kind == ValueKind::file && text.empty())
      fail(ErrorCode::usage, "--{} needs a name", option.name);
    return text;
  }
}

std::string range_text(const OptionInfo& info) {
  const bool below = std::isfinite(info.min), above = std::isfinite(info.max);
  if (below && above) return fmt::format("{} to {}", info.min, info.max);
  if (below) return fmt::format("at least {}", info.min);
  if (above) return fmt::format("at most {}", info.max);
  return "";
}

template <class T>
CommandOption describe_option(const OptionInfo& info) {
  CommandOption o;
  o.name = info.name;
  o.help = info.help;
  o.unit = info.unit;
  o.kind = info.unit == "file" ? ValueKind::file : kind_of<T>();
  if (o.kind == ValueKind::file) o.unit.clear();
  o.range = range_text(info);
  for (const std::string_view word : info.choices)
    if (!word.empty()) o.choices.emplace_back(word);
  for (const auto& [name, letter] : {std::pair("output", 'o'), {"quiet", 'q'}, {"verbose", 'v'}})
    if (o.name == name) o.short_name = letter;
  return o;
}

}  // namespace

template <class T>
void OptionCollector::add(const OptionInfo& info, T& field) {
  CommandOption o = describe_option<T>(info);
  o.default_text = to_text(field);
  if constexpr (std::is_same_v<T, bool>) o.on_by_default = field;
  o.set = [&field, info](const CommandOption& option, const std::string& text) {
    field = parse_as<T>(option, info, text);
  };
  o.get = [&field] { return std::optional<std::string>(to_text(field)); };
  out_.push_back(std::move(o));
}

template <class T>
void OptionCollector::add(const OptionInfo& info, std::optional<T>& field) {
  CommandOption o = describe_option<T>(info);
  o.optional = true;
  const bool file = o.kind == ValueKind::file;
  o.default_text = field ? to_text(*field) : file ? "" : "auto";
  o.set = [&field, file, info](const CommandOption& option, const std::string& text) {
    if (text == "auto" && !file)
      field.reset();
    else
      field = parse_as<T>(option, info, text);
  };
  o.get = [&field]() -> std::optional<std::string> {
    if (!field) return std::nullopt;
    return to_text(*field);
  };
  out_.push_back(std::move(o));
}

template void OptionCollector::add(const OptionInfo&, bool&);
template void OptionCollector::add(const OptionInfo&, int&);
template void OptionCollector::add(const OptionInfo&, double&);
template void OptionCollector::add(const OptionInfo&, Length&);
template void OptionCollector::add(const OptionInfo&, std::string&);
template void OptionCollector::add(const OptionInfo&, std::optional<bool>&);
template void OptionCollector::add(const OptionInfo&, std::optional<int>&);
template void OptionCollector::add(const OptionInfo&, std::optional<double>&);
template void OptionCollector::add(const OptionInfo&, std::optional<Length>&);
template void OptionCollector::add(const OptionInfo&, std::optional<std::string>&);
template void OptionCollector::add(const OptionInfo&, std::optional<Eigen::Vector3d>&);

void OptionCollector::add_words(const OptionInfo& info, const std::function<std::size_t()>& get,
                                const std::function<void(std::size_t)>& set) {
  CommandOption o = describe_option<std::string>(info);
  const std::vector<std::string> words(info.choices.begin(), info.choices.end());  // of every value
  o.default_text = words.at(get());
  o.set = [set, words](const CommandOption&, const std::string& text) {
    set(std::size_t(std::find(words.begin(), words.end(), text) - words.begin()));
  };
  o.get = [get, words] { return std::optional(words.at(get())); };
  out_.push_back(std::move(o));
}

std::string value_name(const CommandOption& option) {
  constexpr std::array kNames = {"",     "COUNT",  "NUMBER",
                                 "WORD", "LENGTH", "FILE"};  // in the order of ValueKind
  return kNames.at(std::size_t(option.kind));
}

bool has_no_form(const CommandOption& option) {
  return option.kind == ValueKind::flag && (option.on_by_default || option.optional);
}

std::vector<std::string> typed_names(const CommandOption& option) {
  std::vector<std::string> names;
  if (!option.on_by_default) names.push_back("--" + option.name);
  if (has_no_form(option)) names.push_back("--no-" + option.name);
  return names;
}

void assign(const CommandOption& option, const std::string& text) {
  const bool automatic = option.optional && text == "auto";
  if (!automatic && !option.choices.empty() &&
      std::find(option.choices.begin(), option.choices.end(), text) == option.choices.end())
    fail(ErrorCode::usage, "--{} is '{}'; it must be one of: {}{}", option.name, text,
         fmt::join(option.choices, ", "), did_you_mean(text, option.choices));
  option.set(option, text);
}

const CommandOption* find_option(const std::vector<CommandOption>& options, const std::string& name) {
  const auto it = std::find_if(options.begin(), options.end(), [&](const auto& o) { return o.name == name; });
  return it == options.end() ? nullptr : &*it;
}

}  // namespace rfsmooth::cli
