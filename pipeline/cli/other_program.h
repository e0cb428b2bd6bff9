/// Sub-commands that are programs of their own, since they link what the command does not.
#pragma once

#include <string>
#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

/// Becomes the program `name` with these arguments: the one beside this program, else the first in PATH.
/// \throw Failure (not_installed) if there is none.
int become_program(const std::string& name, const std::vector<std::string>& arguments);

/// The arguments that say the same again.
std::vector<std::string> as_typed(const Invocation& typed, const std::vector<CommandOption>& options);

}  // namespace rfsmooth::cli
