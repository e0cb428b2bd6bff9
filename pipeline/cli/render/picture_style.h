/// How a picture of clouds or meshes is drawn: options of `rfsmooth render`, and of what draws
/// (clouds/render).
#pragma once

#include <optional>
#include <string>

#include <rfsmooth/options.h>

namespace rfsmooth::render {

/// The same for all of the inputs; what each means, `describe` says.
struct PictureStyle {
  int width = 700, height = 560;
  std::string color = "plain";
  std::string field;
  std::optional<double> low, high;
  int neighbors = 8;
  double splat = 1;
  bool edges = false;
  int levels = 256;
  bool without_outliers = false;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
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
  }
};

}  // namespace rfsmooth::render
