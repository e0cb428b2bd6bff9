#include "pipeline/cli/options/config.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "base/fail.h"
#include "pipeline/cli/options/json_values.h"
#include "pipeline/cli/options/suggest.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::json;

json parse_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(ErrorCode::input_unreadable, "{}: {}", path, std::strerror(errno));
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  if (file.bad()) fail(ErrorCode::input_unreadable, "{}: cannot be read", path);
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    fail(ErrorCode::input_unreadable, "{}: not JSON at byte {}", path, error.byte);
  } catch (const json::exception&) {  // the one other thing that goes wrong in reading
    fail(ErrorCode::usage, "{}: a number in it is too large for any option", path);
  }
}

/// The value as it would be typed after the option.
std::string as_typed(const std::string& path, const std::string& name, const json& value) {
  if (const auto text = typed_text(value)) return *text;
  fail(ErrorCode::usage, "{}: option '{}' must be a number, a word, true, false or null", path, name);
}

std::vector<std::string> names_of(const Command& command) {
  std::vector<std::string> names;
  for (const CommandOption& o : command.options) names.push_back(o.name);
  return names;
}

}  // namespace

Config read_config(const std::string& path, const Command& command) {
  const json root = parse_file(path);
  if (!root.is_object()) fail(ErrorCode::usage, "{}: a JSON object is needed", path);
  if (root.contains("files"))
    fail(ErrorCode::usage,
         "{}: a report of several files; run one of them again by giving the object of its options", path);
  const bool report = root.contains("options");
  if (report && root.contains("command") && root["command"] != command.name)
    fail(ErrorCode::usage, "{}: is a report of 'rfsmooth {}'", path,
         root["command"].is_string() ? root["command"].get<std::string>() : "?");
  const json& options = report ? root["options"] : root;
  if (!options.is_object()) fail(ErrorCode::usage, "{}: 'options' must be an object", path);

  Config config;
  for (const auto& [name, value] : options.items()) {
    const CommandOption* const option = find_option(command.options, name);
    if (option == nullptr || name == "config")
      fail(ErrorCode::usage, "{}: unknown option '{}'{}", path, name, did_you_mean(name, names_of(command)));
    if (value.is_null() && option->kind == ValueKind::file) continue;  // left out
    config.options.emplace_back(name, as_typed(path, name, value));
  }
  if (report)
    for (const char* key : {"input", "output"})
      if (const auto it = root.find(key);
          it != root.end() && it->is_object() && it->contains("path") && (*it)["path"].is_string())
        config.arguments.push_back((*it)["path"].get<std::string>());
  return config;
}

}  // namespace rfsmooth::cli
