#include "rfsmooth/pipeline/cli/command.h"

namespace rfsmooth::cli {

std::vector<Command> all_commands() {
  return {man_command(), completion_command()};
}

}  // namespace rfsmooth::cli
