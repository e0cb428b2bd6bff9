#include <algorithm>

#include <fmt/format.h>

#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/commands/reconstruct_command.h"
#include "pipeline/cli/commands/render_command.h"

namespace rfsmooth::cli {

Command text_command(std::string name, std::string summary, std::string usage, std::string description,
                     std::function<std::string(const std::vector<std::string>& arguments)> text) {
  Command command;
  command.name = std::move(name);
  command.summary = std::move(summary);
  command.usage = {std::move(usage)};
  command.description = std::move(description);
  command.listed = false;
  command.run = [text = std::move(text)](const Invocation& typed) {
    fmt::print("{}", text(typed.arguments));
    return 0;
  };
  return command;
}

std::vector<Command> all_commands() {
  std::vector<Command> all = {denoise_command(),     tiles_command(),       mesh_command(),
                              smooth_mesh_command(), reconstruct_command(), info_command(),
                              compare_command(),     render_command(),      report_command(),
                              flows_command(),       man_command(),         completion_command()};
  for (Command& command : all)
    if (command.name == "man")
      for (const Command& each : all) command.first_words.push_back(each.name);
  return all;
}

const Command* find_command(const std::vector<Command>& commands, std::string_view name) {
  const auto it =
      std::find_if(commands.begin(), commands.end(), [&](const Command& c) { return c.name == name; });
  return it == commands.end() ? nullptr : &*it;
}

}  // namespace rfsmooth::cli
