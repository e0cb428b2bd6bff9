/// render_cloud: a picture of a cloud, of a mesh, or of two side by side from the same place; no display
/// needed.
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "clouds/render/scene.h"
#include "clouds/scanner/arguments.h"
#include "pipeline/io/io.h"

namespace {

using namespace rfsmooth;
using namespace rfsmooth::render;
namespace io = rfsmooth::pipeline::io;
using Eigen::Vector3d;

struct RenderOptions {
  int width = 700, height = 560;
  int neighbors = 8;
  double splat = 1;
  bool edges = false;
  std::string color = "plain";
  std::string field;
  std::optional<double> low, high;
  int levels = 256;

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

struct Request {
  std::vector<std::string> inputs;
  std::string out, title;
  std::vector<std::string> labels;
  std::vector<double> direction, up, zoom;
  bool force = false;
  RenderOptions options;
};

std::optional<Vector3d> vector_of(const std::vector<double>& v) {
  if (v.empty()) return std::nullopt;
  const Vector3d out(v[0], v[1], v[2]);
  if (!out.allFinite() || out.squaredNorm() == 0)
    throw Failure({ErrorCode::usage, "a direction must be three finite numbers, not all zero"});
  return out;
}

/// Middle of the finite points, so that large coordinates lose nothing on the way to the picture.
Vector3d middle(const io::Cloud& cloud) {
  const std::vector<double> xyz = io::positions(cloud);
  Vector3d lower = Vector3d::Constant(INFINITY), upper = -lower;
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    const Vector3d p = Eigen::Map<const Vector3d>(xyz.data() + i);
    if (!p.allFinite()) continue;
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  return lower[0] <= upper[0] ? Vector3d(lower + (upper - lower) / 2) : Vector3d(Vector3d::Zero());
}

/// One value per point of `scene` for --color height, field and displacement; empty for the others.
std::vector<double> color_values(const RenderOptions& options, const std::vector<io::Cloud>& clouds,
                                 const std::vector<Scene>& scenes, std::size_t which) {
  const Scene& scene = scenes[which];
  std::vector<double> values;
  if (options.color == "height")
    for (const Vector3d& p : scene.points) values.push_back(p[2]);
  if (options.color == "field") {
    const auto field = io::find_field(clouds[which], options.field);
    if (!field) throw Failure({ErrorCode::usage, "the cloud has no field called '" + options.field + "'"});
    const std::vector<double> all = io::field_values(clouds[which], *field);
    for (const Index row : scene.row) values.push_back(all[row]);
  }
  if (options.color == "displacement") {
    if (scenes.size() != 2 || clouds[0].size() != clouds[1].size())
      throw Failure(
          {ErrorCode::usage, "--color displacement needs two clouds with the same number of points"});
    const std::vector<double> a = io::positions(clouds[0]), b = io::positions(clouds[1]);
    for (const Index row : scene.row)
      values.push_back(
          (Eigen::Map<const Vector3d>(&a[3 * row]) - Eigen::Map<const Vector3d>(&b[3 * row])).norm());
  }
  return values;
}

void colorize(const RenderOptions& options, const std::vector<io::Cloud>& clouds,
              std::vector<Scene>& scenes) {
  std::vector<std::vector<double>> values;
  std::vector<double> all;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    values.push_back(color_values(options, clouds, scenes, i));
    all.insert(all.end(), values.back().begin(), values.back().end());
    if (options.color == "rgb" && !color_by_file(scenes[i], clouds[i]))
      throw Failure({ErrorCode::usage, "--color rgb: the cloud has no colours"});
  }
  if (all.empty()) return;
  ColorRange range = usual_range(std::move(all));
  if (options.color == "displacement") range.low = 0;
  range = {options.low.value_or(range.low), options.high.value_or(range.high)};
  for (std::size_t i = 0; i < scenes.size(); ++i) color_by(scenes[i], values[i], range);
  std::printf("colours from %g (dark blue) to %g (yellow)\n", range.low, range.high);
}

/// Pictures beside each other, a line of text above each and a title above all.
Image page(const std::vector<Image>& pictures, const Request& request) {
  constexpr int kGap = 8, kScale = 2;
  const int line = text_height(kScale) + 2 * kGap;
  const int title = request.title.empty() ? 0 : line, label = request.labels.empty() ? 0 : line;
  const int width = int(pictures.size()) * (request.options.width + kGap) - kGap;
  Image out(width, title + label + request.options.height, Color(1, 1, 1));
  const Color ink(0.1F, 0.1F, 0.1F);
  write_text(out, (width - text_width(request.title, kScale)) / 2, kGap, request.title, ink, kScale);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int left = int(i) * (request.options.width + kGap);
    paste(out, pictures[i], left, title + label);
    if (i >= request.labels.size()) continue;
    const std::string& text = request.labels[i];
    write_text(out, left + (request.options.width - text_width(text, kScale)) / 2, title + kGap, text, ink,
               kScale);
  }
  return out;
}

void run(const Request& request) {
  const RenderOptions& options = request.options;
  value_or_throw(validate(options));
  std::vector<io::Cloud> clouds;
  for (const std::string& path : request.inputs)
    clouds.push_back(value_or_throw(io::read_cloud(path, {}, {})));
  const Vector3d origin = middle(clouds.front());
  std::vector<Scene> scenes;
  for (const io::Cloud& cloud : clouds) {
    scenes.push_back(make_scene(cloud, origin, {}));
    if (!scenes.back().is_mesh()) estimate_surfels(scenes.back(), options.neighbors, {});
  }
  colorize(options, clouds, scenes);
  CameraOptions look;
  look.direction = vector_of(request.direction);
  look.up = vector_of(request.up);
  if (!request.zoom.empty()) {
    look.centre_x = request.zoom[0];
    look.centre_y = request.zoom[1];
    look.zoom = request.zoom[2];
    if (!(look.zoom > 0)) throw Failure({ErrorCode::usage, "--zoom: the magnification must be positive"});
  }
  // All pictures are taken from where the first one fills the frame.
  const Camera camera(scenes.front().points, look, options.width, options.height);
  DrawOptions how;
  how.edges = options.edges;
  how.splat_scale = options.splat;
  std::vector<Image> pictures;
  for (const Scene& scene : scenes)
    pictures.push_back(draw(scene, camera, options.width, options.height, how));
  value_or_throw(
      io::write_bytes(to_png(page(pictures, request), options.levels), request.out, request.force, {}));
  std::printf("%s\n", request.out.c_str());
}

int parse_and_run(int argc, char** argv) {
  CLI::App app(
      "A picture of a cloud or mesh, or of several side by side from the same place (before | after).");
  Request request;
  app.add_option("INPUT", request.inputs, "clouds or meshes: .ply, .pcd, .xyz, .off")->required();
  app.add_option("-o,--output", request.out, "PNG to write")->required();
  app.add_option("--title", request.title, "text above the picture");
  app.add_option("--label", request.labels, "text above each input, in order")->take_all();
  app.add_option("--direction", request.direction, "from the eye into the scene: three numbers")->expected(3);
  app.add_option("--up", request.up, "what points up in the picture: three numbers")->expected(3);
  app.add_option("--zoom", request.zoom,
                 "middle (x and y as shares of the full frame from its left and top) and magnification")
      ->expected(3);
  app.add_flag("--force", request.force, "replace an existing file");
  clouds::bind(app, request.options);
  if (const auto ended = clouds::parse(app, argc, argv)) return *ended;
  run(request);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return rfsmooth::clouds::tell_failures("render_cloud", parse_and_run, argc, argv);
}
