/// The main function of every program of rfsmooth: parses argv, runs one command, turns every failure into
/// one line and an exit code.
#pragma once

#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

/// Runs the command that argv names and closes standard output. \return the exit code.
int run_program(int argc, const char* const* argv, const std::vector<Command>& commands);

/// The same of a program that is one command, whose name is not typed.
int run_program(int argc, const char* const* argv, const Command& command);

}  // namespace rfsmooth::cli
