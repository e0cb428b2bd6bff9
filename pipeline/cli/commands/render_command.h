/// rfsmooth render: one table of options, seen by two programs, as with `reconstruct`: the command hands the
/// work to rfsmooth-render, which links what draws and writes PNG.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/console/console.h"
#include "pipeline/cli/render/picture_style.h"

namespace rfsmooth::cli {

/// What a picture shows, and how.
struct RenderOptions {
  std::optional<std::string> output, title, labels;
  std::optional<std::string> direction, up, zoom;  // three numbers each
  render::PictureStyle style;
  bool force = false;
  ConsoleOptions console;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"output", "the picture, a PNG", "file"}, self.output);
    visit(OptionInfo{"labels", "text above each input, in order: before,after", ""}, self.labels);
    visit(OptionInfo{"title", "text above all", ""}, self.title);
    visit(OptionInfo{"direction", "from the eye into the scene: x,y,z; auto: across the widest side", ""},
          self.direction);
    visit(OptionInfo{"up", "what points up in the picture: x,y,z; auto: z, or y if looking along z", ""},
          self.up);
    visit(
        OptionInfo{"zoom",
                   "x,y,magnification: what is enlarged, as shares of the full picture from its left and top",
                   ""},
        self.zoom);
    render::PictureStyle::describe(self.style, visit);
    visit(OptionInfo{"force", "replace an existing file", ""}, self.force);
    ConsoleOptions::describe(self.console, visit);
  }
};

/// As the command has it: `run` becomes the program rfsmooth-render.
Command render_command();

/// As the program has it: `draw` makes the picture of the inputs. \throw Failure.
Command render_command(
    std::function<void(const RenderOptions&, const std::vector<std::string>& inputs)> draw);

}  // namespace rfsmooth::cli
