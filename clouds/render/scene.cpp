#include "clouds/render/scene.h"

#include <algorithm>
#include <cmath>

#include "base/fail.h"
#include "base/linear/symmetric_eigen.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "clouds/render/rasterizer.h"
#include "pipeline/io/mesh_file.h"
#include "pipeline/io/point_fields.h"
#include "pipeline/outliers.h"
#include "rfs_mesh/measure.h"
#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::render {

using Eigen::Vector3d;
namespace io = pipeline::io;

namespace {
const Color kClay(0.93F, 0.89F, 0.83F);
const Color kBackground(1, 1, 1);
const Color kLine(0.16F, 0.20F, 0.28F);
}  // namespace

Scene make_scene(const io::Cloud& cloud, const Vector3d& origin, const Context& context) {
  const std::vector<double> xyz = io::positions(cloud, context);
  Scene scene;
  std::vector<Index> index(xyz.size() / 3, kNone);
  for (std::size_t i = 0; i < index.size(); ++i) {
    const Vector3d p = Eigen::Map<const Vector3d>(xyz.data() + 3 * i);
    if (!p.allFinite()) continue;
    index[i] = Index(scene.points.size());
    scene.points.push_back(p - origin);
    scene.row.push_back(Index(i));
  }
  if (scene.points.empty()) fail(ErrorCode::no_usable_points, "there is no finite point to draw");
  for (const Face& f : io::faces_of(cloud, context))
    if (index[f[0]] != kNone && index[f[1]] != kNone && index[f[2]] != kNone)
      scene.faces.push_back({index[f[0]], index[f[1]], index[f[2]]});
  for (const Edge& e : io::edges_of(cloud, context))
    if (index[e[0]] != kNone && index[e[1]] != kNone) scene.edges.push_back({index[e[0]], index[e[1]]});
  scene.colors.assign(scene.points.size(), kClay);
  return scene;
}

void leave_out_outliers(Scene& scene, const Context& context) {
  const auto cloud =
      value_or_throw(rfs_mesh::make_working_cloud(scene.points.front().data(), scene.points.size(), context));
  const std::vector<char> outlier = pipeline::find_outliers(cloud.points, context);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (outlier[cloud.of_input[i]] != 0) continue;
    scene.points[kept] = scene.points[i];
    scene.row[kept++] = scene.row[i];
  }
  scene.points.resize(kept);
  scene.row.resize(kept);
  scene.colors.resize(kept);
}

void estimate_surfels(Scene& scene, int neighbors, const Context& context) {
  const std::size_t n = scene.points.size();
  scene.normals.assign(n, Vector3d::UnitZ());
  scene.reach.assign(n, 0);
  const rfs_mesh::SpatialIndex index(scene.points, context);
  const rfs_mesh::NeighborTable nearest = index.nearest(neighbors, context);
  if (nearest.k < 3) return;
  const auto sixth = std::size_t(std::min(nearest.k, 6) - 1);
  for_each_index(context, n, [&](std::size_t i) {
    const auto row = nearest[i];
    Vector3d mean = scene.points[i];
    for (const Index j : row) mean += scene.points[j];
    mean /= double(row.size() + 1);
    const auto product = [&](const Vector3d& p) -> Eigen::Matrix3d {
      return (p - mean) * (p - mean).transpose();
    };
    Eigen::Matrix3d spread = product(scene.points[i]);
    for (const Index j : row) spread += product(scene.points[j]);
    scene.normals[i] = symmetric_eigen_closed(spread).vectors.col(0);
    scene.reach[i] = 0.8 * (scene.points[row[sixth]] - scene.points[i]).norm();
  });
  std::vector<double> sorted = scene.reach;
  const double median = rfsmooth::median(sorted);
  for (double& r : scene.reach) r = r > 3 * median ? median : r;
}

void color_by(Scene& scene, const std::vector<double>& values, const ColorRange& range) {
  const double span = range.high > range.low ? range.high - range.low : 1;
  for (std::size_t i = 0; i < values.size(); ++i)
    scene.colors[i] = scale_color((values[i] - range.low) / span);
}

ColorRange usual_range(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
               values.end());
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 50;
  return {values[cut], values[values.size() - 1 - cut]};
}

bool color_by_file(Scene& scene, const io::Cloud& cloud) {
  const std::vector<io::Rgb> own = io::colors_of(cloud);
  for (std::size_t i = 0; !own.empty() && i < scene.points.size(); ++i) {
    const io::Rgb& c = own[scene.row[i]];
    scene.colors[i] = Color(float(c[0]), float(c[1]), float(c[2])) / 255.0F;
  }
  return !own.empty();
}

Image draw(const Scene& scene, const Camera& camera, int width, int height, const DrawOptions& options) {
  constexpr int kSuper = 2;  // drawn at twice the size, for smooth edges
  Rasterizer raster(kSuper * width, kSuper * height, kBackground);
  Positions at(scene.points.size());
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = kSuper * camera.project(scene.points[i]);
  const auto segment = [&](Index a, Index b, const Color& color) {
    raster.line(at[a], at[b], kSuper, color);
  };
  for (const Face& f : scene.faces) {
    const Vector3d normal = rfs_mesh::face_cross(scene.points, f);
    if (normal.squaredNorm() == 0) continue;
    const Color color = (scene.colors[f[0]] + scene.colors[f[1]] + scene.colors[f[2]]) / 3;
    raster.triangle(at[f[0]], at[f[1]], at[f[2]], shade(color, camera.turn(normal.normalized())));
    if (!options.edges) continue;
    for (std::size_t k = 0; k < 3; ++k) segment(f[k], f[(k + 1) % 3], kLine);
  }
  for (const Edge& e : scene.edges) segment(e[0], e[1], kLine);
  for (std::size_t i = 0; i < scene.normals.size(); ++i) {
    const Vector3d normal = camera.turn(scene.normals[i]);
    raster.splat(at[i], normal, kSuper * camera.scale() * scene.reach[i] * options.splat_scale,
                 shade(scene.colors[i], normal));
  }
  return shrink(raster.image(), kSuper);
}

}  // namespace rfsmooth::render
