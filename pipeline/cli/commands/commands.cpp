#include <rfsmooth/flow.h>

#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/commands/reconstruct_command.h"

namespace rfsmooth::cli {

void polish(Command& command) {
  for (CommandOption& option : command.options) {
    for (const auto& [name, letter] : {std::pair("output", 'o'), {"quiet", 'q'}, {"verbose", 'v'}})
      if (option.name == name) option.short_name = letter;
    for (const char* family : {"connect-", "sheets-", "sdg-", "umbrella-", "swap-"})
      if (option.name.rfind(family, 0) == 0) option.advanced = true;
    if (option.name == "flow")
      for (const auto& flow : rfsmooth::flows()) option.choices.emplace_back(flow.name);
  }
}

std::vector<Command> all_commands() {
  return {denoise_command(), mesh_command(),  smooth_mesh_command(), reconstruct_command(), info_command(),
          compare_command(), flows_command(), man_command(),         completion_command()};
}

}  // namespace rfsmooth::cli
