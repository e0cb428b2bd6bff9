#include "clouds/render/picture.h"

#include <cmath>

#include "base/fail.h"
#include "pipeline/io/io.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::render {

namespace io = rfsmooth::pipeline::io;
using Eigen::Vector3d;

namespace {

/// Middle of the finite points, so that large coordinates lose nothing on the way to the picture.
Vector3d middle(const io::Cloud& cloud) {
  const std::vector<double> xyz = io::positions(cloud);
  const auto box = rfs_mesh::finite_box(xyz.data(), cloud.size(), {});
  return box ? Vector3d(box->low + (box->high - box->low) / 2) : Vector3d(Vector3d::Zero());
}

/// One value per point of `scene` for --color height, field and displacement; empty for the others.
std::vector<double> color_values(const PictureOptions& options, const std::vector<io::Cloud>& clouds,
                                 const std::vector<Scene>& scenes, std::size_t which) {
  const Scene& scene = scenes[which];
  std::vector<double> values;
  if (options.style.color == "height")
    for (const Vector3d& p : scene.points) values.push_back(p[2]);
  if (options.style.color == "field") {
    const auto field = io::find_field(clouds[which], options.style.field);
    if (!field) fail(ErrorCode::usage, "the cloud has no field called '{}'", options.style.field);
    if (!clouds[which].points().fields[*field].is_plain())
      fail(ErrorCode::usage, "--color field takes one value for each point; '{}' has several",
           options.style.field);
    const std::vector<double> all = io::field_values(clouds[which], *field);
    for (const Index row : scene.row) values.push_back(all[row]);
  }
  if (options.style.color == "displacement") {
    if (scenes.size() != 2 || clouds[0].size() != clouds[1].size())
      fail(ErrorCode::usage, "--color displacement needs two clouds with the same number of points");
    const std::vector<double> a = io::positions(clouds[0]), b = io::positions(clouds[1]);
    for (const Index row : scene.row)
      values.push_back(
          (Eigen::Map<const Vector3d>(&a[3 * row]) - Eigen::Map<const Vector3d>(&b[3 * row])).norm());
  }
  return values;
}

/// \return what the colours mean, if values chose them.
std::optional<ColorRange> colorize(const PictureOptions& options, const std::vector<io::Cloud>& clouds,
                                   std::vector<Scene>& scenes) {
  std::vector<std::vector<double>> values;
  std::vector<double> all;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    values.push_back(color_values(options, clouds, scenes, i));
    all.insert(all.end(), values.back().begin(), values.back().end());
    if (options.style.color == "rgb" && !color_by_file(scenes[i], clouds[i]))
      fail(ErrorCode::usage, "--color rgb: the cloud has no colours");
  }
  if (all.empty()) return std::nullopt;
  ColorRange range = usual_range(std::move(all));
  if (options.style.color == "displacement") range.low = 0;
  range = {options.style.low.value_or(range.low), options.style.high.value_or(range.high)};
  for (std::size_t i = 0; i < scenes.size(); ++i) color_by(scenes[i], values[i], range);
  return range;
}

/// Pictures beside each other, a line of text above each and a title above all.
Image page(const std::vector<Image>& pictures, const PictureOptions& options) {
  constexpr int kGap = 8, kScale = 2;
  const int line = text_height(kScale) + 2 * kGap;
  const int title = options.title.empty() ? 0 : line, label = options.labels.empty() ? 0 : line;
  const int width = int(pictures.size()) * (options.style.width + kGap) - kGap;
  Image out(width, title + label + options.style.height, Color(1, 1, 1));
  const Color ink(0.1F, 0.1F, 0.1F);
  write_text(out, (width - text_width(options.title, kScale)) / 2, kGap, options.title, ink, kScale);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int left = int(i) * (options.style.width + kGap);
    paste(out, pictures[i], left, title + label);
    if (i >= options.labels.size()) continue;
    const std::string& text = options.labels[i];
    write_text(out, left + (options.style.width - text_width(text, kScale)) / 2, title + kGap, text, ink,
               kScale);
  }
  return out;
}

void check_direction(const std::optional<Vector3d>& v) {
  if (v && (!v->allFinite() || v->squaredNorm() == 0))
    fail(ErrorCode::usage, "a direction must be three finite numbers, not all zero");
}

CameraOptions camera_options(const PictureOptions& options) {
  check_direction(options.direction);
  check_direction(options.up);
  CameraOptions look;
  look.direction = options.direction;
  look.up = options.up;
  if (options.zoom) {
    look.centre_x = (*options.zoom)[0];
    look.centre_y = (*options.zoom)[1];
    look.zoom = (*options.zoom)[2];
    if (!(look.zoom > 0)) fail(ErrorCode::usage, "--zoom: the magnification must be positive");
  }
  return look;
}

}  // namespace

Picture make_picture(const PictureOptions& options, const Context& context) {
  const CameraOptions look = camera_options(options);
  std::vector<io::Cloud> clouds;
  for (const std::string& path : options.inputs)
    clouds.push_back(value_or_throw(io::read_cloud(path, {}, context)));
  const Vector3d origin = middle(clouds.front());
  std::vector<Scene> scenes;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const auto made = guarded([&] { return make_scene(clouds[i], origin, context); });
    scenes.push_back(io::value_or_fail(made, options.inputs[i]));
    if (scenes.back().is_mesh()) continue;
    if (options.style.without_outliers) leave_out_outliers(scenes.back(), context);
    estimate_surfels(scenes.back(), options.style.neighbors, context);
  }
  Picture made;
  made.colors = colorize(options, clouds, scenes);
  // All pictures are taken from where the first one fills the frame.
  const Camera camera(scenes.front().points, look, options.style.width, options.style.height);
  DrawOptions how;
  how.edges = options.style.edges;
  how.splat_scale = options.style.splat;
  std::vector<Image> pictures;
  for (const Scene& scene : scenes)
    pictures.push_back(draw(scene, camera, options.style.width, options.style.height, how));
  made.png = to_png(page(pictures, options), options.style.levels);
  return made;
}

}  // namespace rfsmooth::render
