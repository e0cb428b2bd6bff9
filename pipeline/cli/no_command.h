/// What is said of words that name no sub-command.
#pragma once

#include <string>
#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

/// `words` are what was typed, from the one that stands where a sub-command should. The command most like it,
/// or what does to the files that were named what most people want of this program.
/// \throw Failure (usage).
[[noreturn]] void refuse_words_without_command(const std::vector<std::string>& words,
                                               const std::vector<Command>& commands);

}  // namespace rfsmooth::cli
