/// What every program of rfsmooth does: take argv apart, run one command, turn every failure into one line
/// and an exit code.
#pragma once

#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

/// \return the exit code; standard output is closed.
int run_program(int argc, const char* const* argv, const std::vector<Command>& commands);

}  // namespace rfsmooth::cli
