#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/commands/reconstruct_command.h"
#include "pipeline/cli/commands/render_command.h"

namespace rfsmooth::cli {

void polish(Command& command) {
  for (CommandOption& option : command.options) {
    for (const auto& [name, letter] : {std::pair("output", 'o'), {"quiet", 'q'}, {"verbose", 'v'}})
      if (option.name == name) option.short_name = letter;
  }
}

std::vector<Command> all_commands() {
  return {denoise_command(),     tiles_command(), mesh_command(),    smooth_mesh_command(),
          reconstruct_command(), info_command(),  compare_command(), render_command(),
          report_command(),      flows_command(), man_command(),     completion_command()};
}

}  // namespace rfsmooth::cli
