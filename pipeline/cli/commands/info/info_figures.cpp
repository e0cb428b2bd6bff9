#include "pipeline/cli/commands/info/info_figures.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/outliers.h"
#include "pipeline/tiles/files/statistics_json.h"
#include "pipeline/twins.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/noise/noise.h"
#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/flow_auto.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

/// First, fifth and ninth tenth of a field over the cloud.
ordered_json tenths(std::vector<double> field) {
  std::sort(field.begin(), field.end());
  auto json = ordered_json::array();
  for (const std::size_t tenth : {1, 5, 9}) json.push_back(field[tenth * (field.size() - 1) / 10]);
  return json;
}

/// As `denoise` measures it: outliers, which it leaves where they are, have no part in it.
rfs_mesh::NoiseField noise_of_surface(const rfs_mesh::SpatialIndex& index, const Statistics::Box& box,
                                      const Context& context) {
  Statistics whole;
  whole.box = box;
  const std::vector<char> outlier = pipeline::find_outliers(index, {}, whole, context);
  Positions kept;
  for (std::size_t i = 0; i < outlier.size(); ++i)
    if (outlier[i] == 0) kept.push_back(index.points()[i]);
  return rfs_mesh::spread_noise(rfs_mesh::known_noise(index, whole, context), kept, context);
}

/// Finite and distinct points, bounding box, mean distance to the nearest other point.
ordered_json measure(const pipeline::io::Cloud& cloud, const Context& context) {
  const std::vector<double> xyz = pipeline::io::positions(cloud, context);
  ordered_json json = {{"finite", 0},           {"distinct", 0},
                       {"low", nullptr},        {"high", nullptr},
                       {"spacing", nullptr},    {"spacing_field", nullptr},
                       {"noise", nullptr},      {"noise_measured", nullptr},
                       {"noise_field", nullptr}};
  auto working = rfs_mesh::make_working_cloud(xyz.data(), cloud.size(), context);
  if (!working.ok()) {
    if (working.error().code == ErrorCode::no_usable_points) return json;
    throw Failure(working.error());
  }
  const Positions& points = working.value().points;
  json["finite"] = working.value().finite();
  json["distinct"] = points.size();
  const auto& [low, high] = working.value().box;
  json["low"] = {low[0], low[1], low[2]};
  json["high"] = {high[0], high[1], high[2]};
  if (points.size() < 2) return json;
  in_arena(context, [&] {
    std::optional<rfs_mesh::SpatialIndex> searched(std::in_place, points, context);
    const rfs_mesh::NeighborTable near =
        pipeline::nearest_joined(searched, working.value(), int(rfs_mesh::kRing), context);
    const rfs_mesh::SpatialIndex& index = *searched;
    json["spacing"] = rfs_mesh::mean_spacing(points, near, context);
    json["spacing_field"] = tenths(rfs_mesh::measure_spacing(index, context));
    rfs_mesh::NoiseField noise = noise_of_surface(index, working.value().box, context);
    json["noise"] = noise.sigma;
    json["noise_measured"] = pipeline::tiles::json_of(smoothing::summary_of(noise));
    json["noise_field"] = tenths(std::move(noise.local));
  });
  return json;
}

}  // namespace

ordered_json info_of(const pipeline::io::Cloud& cloud, const Context& context) {
  ordered_json info = describe(cloud);
  info.update(measure(cloud, context));
  return info;
}

}  // namespace rfsmooth::cli
