/// rfsmooth render: one table of options, seen by two programs, as with `reconstruct`: the command hands the
/// work to rfsmooth-render, which links what draws and writes PNG.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/console/console.h"
#include "pipeline/cli/files/file_options.h"

namespace rfsmooth::cli {

/// What a picture shows, and how.
struct RenderOptions {
  std::optional<std::string> output, title, labels;
  std::optional<std::string> direction, up, zoom;  // three numbers each
  int width = 700, height = 560;
  int neighbors = 8;
  double splat = 1;
  bool edges = false;
  std::string color = "plain";
  std::string field;
  std::optional<double> low, high;
  int levels = 256;
  bool without_outliers = false;
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
    visit(OptionInfo{"width", "of each picture", "pixels", 16, 10000}, self.width);
    visit(OptionInfo{"height", "of each picture", "pixels", 16, 10000}, self.height);
    OptionInfo color{"color", "what colours the points", ""};
    color.choices = {"plain", "rgb", "height", "field", "displacement"};
    visit(color, self.color);
    visit(OptionInfo{"field", "with --color field: which", ""}, self.field);
    visit(OptionInfo{"low", "value at the dark blue end; auto: from the data", ""}, self.low);
    visit(OptionInfo{"high", "value at the yellow end; auto: from the data", ""}, self.high);
    visit(OptionInfo{"neighbors", "points a normal is estimated from; few show the noise", "points", 3, 200},
          self.neighbors);
    visit(OptionInfo{"splat", "size of the points", "x what covers the surface", 0.01, 20}, self.splat);
    visit(OptionInfo{"edges", "draw the edges of faces", ""}, self.edges);
    visit(OptionInfo{"levels", "of brightness per colour; fewer make a smaller file", "", 2, 256},
          self.levels);
    visit(OptionInfo{"without-outliers", "leave out points of clouds with no surface near them", ""},
          self.without_outliers);
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
