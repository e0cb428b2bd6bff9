/// Option values as JSON.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "pipeline/cli/options/option.h"

namespace rfsmooth::cli {

/// The JSON of a value as typed: numbers, true and false become JSON's own, the rest strings.
nlohmann::ordered_json json_value(const std::string& text);

/// All options that have a value, by name; `auto` ones are null.
nlohmann::ordered_json json_object(const std::vector<CommandOption>& options);

}  // namespace rfsmooth::cli
