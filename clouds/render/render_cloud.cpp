/// render_cloud: `rfsmooth render` with arguments as the scripts of this folder write them.
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "clouds/render/picture.h"
#include "clouds/scanner/arguments.h"
#include "pipeline/io/io.h"

namespace {

using namespace rfsmooth;

struct RenderCloudOptions : render::PictureOptions {
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"width", "of each picture", "pixels", 16, 10000}, self.width);
    visit(OptionInfo{"height", "of each picture", "pixels", 16, 10000}, self.height);
    visit(OptionInfo{"neighbors", "points a normal is estimated from; few show the noise", "", 3, 200},
          self.neighbors);
    visit(OptionInfo{"splat", "size of the points", "x what covers the surface", 0.01, 20}, self.splat);
    visit(OptionInfo{"edges", "draw the edges of faces", ""}, self.edges);
    visit(OptionInfo{"color", "by", "", 0, 0, {"plain", "rgb", "height", "field", "displacement"}},
          self.color);
    visit(OptionInfo{"field", "the field to colour by", ""}, self.field);
    visit(OptionInfo{"low", "value at the dark end; empty = from the data", ""}, self.low);
    visit(OptionInfo{"levels", "of brightness per colour; fewer make a smaller file", "", 2, 256},
          self.levels);
    visit(OptionInfo{"high", "value at the bright end; empty = from the data", ""}, self.high);
  }
};

std::optional<Eigen::Vector3d> vector_of(const std::vector<double>& v) {
  if (v.empty()) return std::nullopt;
  return Eigen::Vector3d(v[0], v[1], v[2]);
}

int parse_and_run(int argc, char** argv) {
  CLI::App app(
      "A picture of a cloud or mesh, or of several side by side from the same place (before | after).");
  RenderCloudOptions request;
  std::string out;
  std::vector<double> direction, up, zoom;
  bool force = false;
  app.add_option("INPUT", request.inputs, "clouds or meshes: .ply, .pcd, .xyz, .off, .las")->required();
  app.add_option("-o,--output", out, "PNG to write")->required();
  app.add_option("--title", request.title, "text above the picture");
  app.add_option("--label", request.labels, "text above each input, in order")->take_all();
  app.add_option("--direction", direction, "from the eye into the scene: three numbers")->expected(3);
  app.add_option("--up", up, "what points up in the picture: three numbers")->expected(3);
  app.add_option("--zoom", zoom,
                 "middle (x and y as shares of the full frame from its left and top) and magnification")
      ->expected(3);
  app.add_flag("--force", force, "replace an existing file");
  clouds::bind(app, request);
  if (const auto ended = clouds::parse(app, argc, argv)) return *ended;
  value_or_throw(validate(request));
  request.direction = vector_of(direction);
  request.up = vector_of(up);
  request.zoom = vector_of(zoom);
  const render::Picture made = render::make_picture(request, {});
  if (made.colors)
    std::printf("colours from %g (dark blue) to %g (yellow)\n", made.colors->low, made.colors->high);
  value_or_throw(pipeline::io::write_bytes(made.png, out, force, {}));
  std::printf("%s\n", out.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return rfsmooth::clouds::tell_failures("render_cloud", parse_and_run, argc, argv);
}
