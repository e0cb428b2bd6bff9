/// Help texts, made from the tables of the commands' options.
#pragma once

#include <string>
#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

/// Every command in one screen.
std::string overview(const std::vector<Command>& commands, bool complete);

/// One command: usage and everyday options; `complete`: description, every option, exit codes.
std::string help_of(const Command& command, bool complete);

/// "-o, --output FILE".
std::string option_heading(const CommandOption& option);

/// The limits and the default, as in "0 to 1, default auto"; "" if there are none.
std::string option_limits(const CommandOption& option);

struct ExitCode {
  int code;
  const char* meaning;
};
const std::vector<ExitCode>& exit_codes();

}  // namespace rfsmooth::cli
