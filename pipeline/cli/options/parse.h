/// From argv to a sub-command, its options and arguments. The only user of CLI11.
#pragma once

#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

struct Parsed {
  const Command* command = nullptr;  ///< null: none was named (help or version of the whole)
  Invocation invocation;
};

/// Splits `argv` by the options of `commands`; does not parse the values yet. \throw Failure (usage) for an
/// unknown sub-command or option (with a suggestion), a missing value, or an option given twice.
Parsed parse(int argc, const char* const* argv, const std::vector<Command>& commands);

}  // namespace rfsmooth::cli
