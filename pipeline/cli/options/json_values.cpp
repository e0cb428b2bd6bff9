#include "pipeline/cli/options/json_values.h"

#include "pipeline/cli/options/text_values.h"

namespace rfsmooth::cli {

nlohmann::ordered_json json_value(const std::string& text) {
  if (text == "true") return true;
  if (text == "false") return false;
  if (const auto integer = read_integer(text)) return *integer;
  if (const auto number = read_number(text)) return *number;
  return text;
}

nlohmann::ordered_json json_object(const std::vector<CommandOption>& options) {
  auto object = nlohmann::ordered_json::object();
  for (const CommandOption& o : options) {
    const auto text = o.get();
    object[o.name] = text ? json_value(*text) : nlohmann::ordered_json();
  }
  return object;
}

}  // namespace rfsmooth::cli
