/// rfsmooth reconstruct: one table of options, seen by two programs. The command knows it for help, manual
/// pages, completion and strict parsing, and hands the work to rfsmooth-reconstruct, which links the
/// libraries that make surfaces; so the command itself stays without them.
#pragma once

#include <vector>

#include <rfsmooth/reconstruct.h>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

/// As the command has it: `run` becomes the program rfsmooth-reconstruct.
Command reconstruct_command();

/// As the program has it: `run` does the work with `methods`.
Command reconstruct_command(std::vector<SurfaceMethod> methods);

}  // namespace rfsmooth::cli
