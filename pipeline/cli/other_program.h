/// What was typed, to be handed on: to programs of their own, which link what the command does not, and to
/// people who want to do it again.
#pragma once

#include <string>
#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

/// Replaces this process by the program `name` with these arguments: the one beside this program, else the
/// first in PATH. \throw Failure (not_installed) if there is none.
int become_program(const std::string& name, const std::vector<std::string>& arguments);

/// The arguments that mean the same as `typed`.
std::vector<std::string> as_typed(const Invocation& typed, const std::vector<CommandOption>& options);

/// The same as one line for a shell.
std::string command_line(const std::string& command, const Invocation& typed,
                         const std::vector<CommandOption>& options);

}  // namespace rfsmooth::cli
