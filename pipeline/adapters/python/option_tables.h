/// The options of the command's sub-commands as Python sees them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::python {

/// Names, as the command has them, and values, as they would be typed.
using OptionTexts = std::vector<std::pair<std::string, std::string>>;

/// The sub-command of that name. \throw std::invalid_argument.
cli::Command command_of(const std::string& name);

/// Gives the options of `command` their values and checks them together. \throw Failure (usage).
void assign_all(const cli::Command& command, const OptionTexts& options);

/// The options of a sub-command that say what is done, not where files and messages go: a list of dicts with
/// name, kind, default (the value as typed, or None for what is chosen from the data), optional (whether None
/// may be given), choices, help, unit, range. The default of an option of flows is the value that all flows
/// that have it agree on, else None.
nanobind::list option_table(const std::string& command);

}  // namespace rfsmooth::python
