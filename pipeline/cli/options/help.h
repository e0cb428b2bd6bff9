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

/// What it does, its limits and its default.
std::string option_help(const CommandOption& option);

}  // namespace rfsmooth::cli
