/// --config: options from a JSON file, which may be a report of an earlier run.
#pragma once

#include <string>
#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

struct Config {
  std::vector<std::pair<std::string, std::string>> options;  ///< name and text
  std::vector<std::string> arguments;  ///< the report's input and output, if it has them
};

/// Reads `path`: a report (its "options", "input", "output") or an object of options. Names are checked
/// against `command`. \throw Failure: input_unreadable (no JSON; says the byte), usage (another command's
/// report, or an unknown option, with a suggestion).
Config read_config(const std::string& path, const Command& command);

}  // namespace rfsmooth::cli
