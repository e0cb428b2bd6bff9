/// --config: options from a JSON file, which may be a report of an earlier run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

struct Config {
  std::vector<std::pair<std::string, std::string>> options;  ///< name and text
  std::vector<std::string>
      arguments;  ///< the report's input and output, or its inputs where there are several
  std::optional<std::string> folder;  ///< of several outputs
};

/// Reads `path`: a report (its "options", "input", "output"; of several files the options of the first that
/// was done, for all have the same) or an object of options. Names are checked against `command`. \throw
/// Failure: input_unreadable (no JSON; says the byte), usage (another command's report, or an unknown option,
/// with a suggestion).
Config read_config(const std::string& path, const Command& command);

}  // namespace rfsmooth::cli
