/// From argv to a sub-command and its arguments. The one place that sees CLI11.
#pragma once

#include <string>
#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

struct Parsed {
  const Command* command = nullptr;  ///< null: none was named (help or version of the whole)
  Invocation invocation;
};

/// Takes `argv` apart by the options of `commands`. Values are not read yet.
/// \throw Failure (usage) for an unknown sub-command or option (with a suggestion), a missing value, an
/// option given twice.
Parsed parse(int argc, const char* const* argv, const std::vector<Command>& commands);

}  // namespace rfsmooth::cli
