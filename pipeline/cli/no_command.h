/// The error message for words that name no sub-command.
#pragma once

#include <string>
#include <vector>

#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

/// Refuses `words`, which were typed from the place of the sub-command on. The message suggests the
/// sub-command with the most similar name; or, if a file was named, `denoise` for it; or the sub-command that
/// does what the word means elsewhere. \throw Failure (usage).
[[noreturn]] void refuse_words_without_command(const std::vector<std::string>& words,
                                               const std::vector<Command>& commands);

}  // namespace rfsmooth::cli
