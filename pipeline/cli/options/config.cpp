#include "pipeline/cli/options/config.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "base/fail.h"
#include "pipeline/cli/options/json_values.h"
#include "pipeline/cli/options/suggest.h"
#include "pipeline/io/json_file.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::json;

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

/// The part of a report that has options: that of a file that was done. No report: the object itself.
const json& part_with_options(const std::string& path, const json& root) {
  if (!root.contains("files")) return root;
  for (const json& file : root["files"])
    if (file.is_object() && file.contains("options")) return file;
  fail(ErrorCode::usage, "{}: a report of several files, none of which was done", path);
}

std::optional<std::string> path_of(const json& part, const char* key) {
  const auto it = part.find(key);
  if (it == part.end() || !it->is_object() || !it->contains("path") || !(*it)["path"].is_string())
    return std::nullopt;
  return (*it)["path"].get<std::string>();
}

/// Enters the files of a report.
void enter_files(const json& root, Config& config) {
  if (!root.contains("files")) {
    for (const char* key : {"input", "output"})
      if (const auto file = path_of(root, key)) config.arguments.push_back(*file);
    return;
  }
  for (const json& part : root["files"]) {
    if (const auto input = path_of(part, "input")) config.arguments.push_back(*input);
    if (const auto output = path_of(part, "output"))
      config.folder = (std::filesystem::path(*output).parent_path() / "").string();
  }
  if (config.folder == "") config.folder = "./";
}

}  // namespace

Config read_config(const std::string& path, const Command& command) {
  if (path == "-") fail(ErrorCode::usage, "--config takes the name of a file, not standard input (-)");
  const json root = pipeline::io::read_json(path);
  if (!root.is_object()) fail(ErrorCode::usage, "{}: a JSON object is needed", path);
  const json& part = part_with_options(path, root);
  const bool report = part.contains("options");
  if (report && root.contains("command") && root["command"] != command.name)
    fail(ErrorCode::usage, "{}: is a report of 'rfsmooth {}'", path,
         root["command"].is_string() ? root["command"].get<std::string>() : "?");
  const json& options = report ? part["options"] : root;
  if (!options.is_object()) fail(ErrorCode::usage, "{}: 'options' must be an object", path);

  Config config;
  for (const auto& [name, value] : options.items()) {
    if (name == "config") fail(ErrorCode::usage, "{}: 'config' is for the command line only", path);
    const CommandOption* const option = find_option(command.options, name);
    if (option == nullptr)
      fail(ErrorCode::usage, "{}: unknown option '{}'{}", path, name, did_you_mean(name, names_of(command)));
    if (value.is_null() && option->kind == ValueKind::file) continue;  // left out
    config.options.emplace_back(name, as_typed(path, name, value));
  }
  if (report) enter_files(root, config);
  return config;
}

}  // namespace rfsmooth::cli
