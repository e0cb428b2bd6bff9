/// Option values as JSON.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "pipeline/cli/options/option.h"

namespace rfsmooth::cli {

/// The JSON of a value as typed: numbers, true and false become JSON's own, the rest strings.
nlohmann::ordered_json json_value(const std::string& text);

/// The value as it would be typed: null is `auto`. None for arrays and objects.
template <class Json>
std::optional<std::string> typed_text(const Json& value) {
  if (value.is_null()) return "auto";
  if (value.is_string()) return value.template get<std::string>();
  if (value.is_number() || value.is_boolean()) return value.dump();
  return std::nullopt;
}

/// All options that have a value, by name; `auto` ones are null.
nlohmann::ordered_json json_object(const std::vector<CommandOption>& options);

}  // namespace rfsmooth::cli
