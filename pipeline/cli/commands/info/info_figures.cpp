#include "pipeline/cli/commands/info/info_figures.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/prepare.h"
#include "pipeline/tiles/files/statistics_json.h"
#include "rfs_mesh/noise/noise.h"
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

/// Finite and distinct points, bounding box, spacing and noise.
ordered_json measure(const pipeline::io::Cloud& cloud, const Context& context) {
  ordered_json json = {{"finite", 0},           {"distinct", 0},
                       {"low", nullptr},        {"high", nullptr},
                       {"spacing", nullptr},    {"spacing_field", nullptr},
                       {"noise", nullptr},      {"noise_measured", nullptr},
                       {"noise_field", nullptr}};
  const auto measured = guarded([&] {
    return pipeline::measure_points(pipeline::io::positions(cloud, context), Outliers::keep, {}, context);
  });
  if (!measured.ok()) {
    if (measured.error().code == ErrorCode::no_usable_points) return json;
    throw Failure(measured.error());
  }
  const pipeline::Measured& found = measured.value();
  const Statistics& whole = found.statistics;
  json["finite"] = found.finite;
  json["distinct"] = found.distinct;
  const auto& [low, high] = *whole.box;
  json["low"] = {low[0], low[1], low[2]};
  json["high"] = {high[0], high[1], high[2]};
  if (found.distinct < 2) return json;
  json["spacing"] = *whole.spacing;
  in_arena(context, [&] {
    json["spacing_field"] = tenths(rfs_mesh::measure_spacing({found.points, context}, context));
    rfs_mesh::NoiseField noise = rfs_mesh::spread_noise(*whole.noise, found.points, context);
    json["noise"] = smoothing::told_noise(noise);
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
