#include "pipeline/cli/commands/render_command.h"

#include <filesystem>
#include <memory>

#include "base/fail.h"
#include "pipeline/cli/other_program.h"
#include "pipeline/cli/own_files.h"

namespace rfsmooth::cli {

namespace {

Command render_table(const std::shared_ptr<RenderOptions>& options) {
  Command command;
  command.name = "render";
  command.summary = "make a picture of clouds or meshes, side by side";
  command.usage = {"[options] IN... -o OUT.png"};
  command.description =
      "Draws each input from the same place, the one where the first fills the picture: points as small "
      "discs shaded by their neighbourhood, so that noise shows as grain, or faces, or edges. No screen is "
      "needed. rfsmooth render before.ply after.ply -o pair.png --labels before,after\n\n"
      "The work is done by the program rfsmooth-render; without it the exit code is 127.";
  command.options = collect(*options);
  command.everyday = {"output", "labels", "title",  "direction", "up",
                      "zoom",   "width",  "height", "color",     "force"};
  return command;
}

/// Refuses options that were typed and do nothing. \throw Failure (usage).
void check_colours(const RenderOptions& options, const Invocation& typed) {
  const bool by_value = options.style.color != "plain" && options.style.color != "rgb";
  for (const auto& [name, text] : typed.options) {
    if (name == "field" && options.style.color != "field")
      fail(ErrorCode::usage, "--field has no effect without --color field");
    if ((name == "low" || name == "high") && !by_value)
      fail(ErrorCode::usage, "--{} has no effect with --color {}", name, options.style.color);
  }
}

/// Checks before the work. \throw Failure.
void check_request(const RenderOptions& options, const Invocation& typed) {
  if (typed.arguments.empty()) fail(ErrorCode::usage, "no input given");
  if (!options.output) fail(ErrorCode::usage, "no picture named: -o OUT.png");
  if (options.style.color == "field" && options.style.field.empty())
    fail(ErrorCode::usage,
         "--color field needs the name of a field: --field NAME (rfsmooth info lists them)");
  check_colours(options, typed);
  check_no_cloud_target(*options.output, options.force, "picture");
  const std::string extension = std::filesystem::path(*options.output).extension().string();
  if (!extension.empty() && extension != ".png" && extension != ".PNG")
    fail(ErrorCode::usage, "{}: the picture is a PNG; name it .png", *options.output);
}

}  // namespace

Command render_command() {
  const auto options = std::make_shared<RenderOptions>();
  Command command = render_table(options);
  command.run = [options, known = command.options](const Invocation& typed) {
    check_request(*options, typed);
    return become_program("rfsmooth-render", as_typed(typed, known));
  };
  return command;
}

Command render_command(std::function<void(const RenderOptions&, const std::vector<std::string>&)> draw) {
  const auto options = std::make_shared<RenderOptions>();
  Command command = render_table(options);
  command.run = [options, draw = std::move(draw)](const Invocation& typed) {
    check_request(*options, typed);
    draw(*options, typed.arguments);
    return 0;
  };
  return command;
}

}  // namespace rfsmooth::cli
