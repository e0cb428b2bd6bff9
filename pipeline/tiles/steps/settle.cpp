#include "pipeline/tiles/steps/settle.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/io/io.h"
#include "pipeline/io/json_file.h"
#include "pipeline/prepare.h"
#include "pipeline/tiles/allowed.h"
#include "pipeline/tiles/files/records.h"
#include "pipeline/tiles/files/statistics_json.h"
#include "pipeline/tiles/halo.h"
#include "pipeline/tiles/steps/measure.h"
#include "rfs_mesh/connect/umbrella.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::pipeline::tiles {

namespace {

using nlohmann::ordered_json;

constexpr int kRingsOfSwaps = 2;  // a swap changes two faces, and needs their four neighbours to itself

/// Points of all tiles, n x 3: those that are measured, where they are more, and those that are smoothed.
struct Sample {
  std::vector<double> measured, smoothed;
};

Sample sample_of(const Job& job, const Context& context) {
  Sample sample;
  const bool more = job.sample < job.measured;
  const std::size_t rounded_up = job.tiles.size();  // in every tile
  if (more) sample.measured.reserve(3 * (std::size_t(job.measured) + rounded_up));
  sample.smoothed.reserve(3 * (std::size_t(job.sample) + rounded_up));
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    std::vector<Record> points = read_records(job.sampled(t), context);
    if (more) append_places(points, sample.measured);
    keep_middle(job, t, job.sample, points);
    append_places(points, sample.smoothed);
  }
  return sample;
}

/// Points of the widest patch that the flow or the measuring of the noise looks at.
std::size_t widest_patch(const DenoiseOptions& options, const Statistics& found) {
  std::size_t widest = std::size_t(options.connect.neighbours);
  if (found.scale) widest = std::max(widest, found.scale->neighbours);
  if (found.noise) widest = std::max(widest, found.noise->piece);
  for (const auto& pass : found.passes)
    for (const auto& scale : pass.scales) widest = std::max(widest, scale.members);
  for (const auto& part : found.parts) widest = std::max(widest, widest_patch(options, part.own));
  return widest;
}

/// How far away a point may be that has a say in where another goes: through quadrics, the rough mesh's
/// neighbourhoods and the patches (kHaloRadii), then along the mesh. Fills `widest`, `radii` and `halo`.
/// \param sample of the points
void find_halo(const DenoiseOptions& options, const Positions& sample, const Context& context,
               Settled& settled) {
  settled.widest = widest_patch(options, settled.report.statistics);
  const double radius = typical_radius(sample, settled.widest, context);
  settled.halo = kHaloRadii * radius;
  if (const auto rings = support_rings(options.flow)) {
    const int swaps = options.swap ? std::max(0, iterations(options.flow.flow) - 1) : 0;
    const double longest_edge = typical_radius(sample, rfs_mesh::kMostRibs, context);
    settled.halo += (*rings + kRingsOfSwaps * swaps) * longest_edge;
  }
  settled.radii = radius > 0 ? settled.halo / radius : kHaloRadii;
}

/// Measures and smooths the sample as the cloud that it stands for.
Settled settle_sample(const Job& job, Sample sample, const DenoiseOptions& options, const Context& context) {
  DenoiseOptions how = options;
  how.statistics.emplace();
  how.statistics->box = job.box;
  if (!sample.measured.empty())
    how.statistics =
        measure_points(std::move(sample.measured), how.outliers, *how.statistics, context).statistics;
  const std::size_t n = sample.smoothed.size() / 3;
  if (n < job.in_tiles()) how.statistics->points = std::size_t(job.in_tiles());
  std::vector<double> smooth = sample.smoothed;
  Settled settled;
  settled.report = value_or_throw(denoise(smooth.data(), n, how, context));
  in_arena(context,
           [&] { find_halo(options, distinct_places(io::points_of(sample.smoothed)), context, settled); });
  return settled;
}

ordered_json json_of_settled(const Settled& settled) {
  const DenoiseReport& report = settled.report;
  return {{"halo", settled.halo},
          {"halo_radii", settled.radii},
          {"widest", settled.widest},
          {"noise", report.noise},
          {"noise_left", io::or_null(report.noise_left)},
          {"noise_measured", json_of(report.measured)},
          {"not_smoothed", json_of(report.not_smoothed)},
          {"guide_strength", report.guide_strength},
          {"tail_times", report.tail_times},
          {"spacing", report.spacing},
          {"statistics", json_of(report.statistics)}};
}

Settled settled_of_json(const ordered_json& json) {
  Settled settled = {{}, json.at("halo"), json.at("halo_radii"), json.at("widest")};
  DenoiseReport& report = settled.report;
  report.statistics = statistics_of(json.at("statistics"));
  report.noise = json.at("noise");
  if (const auto& left = json.at("noise_left"); !left.is_null()) report.noise_left = left.get<double>();
  report.measured = summary_of(json.at("noise_measured"));
  report.not_smoothed = not_smoothed_of(json.at("not_smoothed"));
  report.guide_strength = json.at("guide_strength");
  report.tail_times = json.at("tail_times");
  report.spacing = json.at("spacing");
  return settled;
}

}  // namespace

void settle_job(const Job& job, const DenoiseOptions& options, const Context& context) {
  if (is_settled(job)) return;
  check_for_tiles(options);
  for (std::size_t t = 0; t < job.tiles.size(); ++t)
    if (!is_measured(job, t, context)) refuse_step(job, fmt::format("tile {} is not measured yet", t));
  const Settled settled = settle_sample(job, sample_of(job, context), options, context);
  const std::string text = json_of_settled(settled).dump(1) + '\n';
  value_or_throw(io::write_bytes(text, job.settled(), true, context));
}

bool is_settled(const Job& job) {
  return std::filesystem::exists(job.settled());
}

Settled settled_of(const Job& job) {
  if (!is_settled(job)) refuse_step(job, "is not settled yet");
  return read_settled(job.settled());
}

Settled read_settled(const std::filesystem::path& path) {
  const ordered_json json = io::read_json(path);
  try {
    Settled settled = settled_of_json(json);
    std::vector<std::string> wrong = check(settled.report.statistics);
    if (!(settled.halo >= 0 && settled.halo <= rfs_mesh::kLargestSide && settled.radii > 0 &&
          settled.radii <= rfs_mesh::kLargestSide && settled.widest >= 1 && settled.widest < kNone))
      wrong.emplace_back("halo, halo_radii or widest: is no length or no number of points");
    if (!wrong.empty()) fail(ErrorCode::input_unreadable, "{}: {}", path.string(), wrong.front());
    return settled;
  } catch (const nlohmann::json::exception& error) {
    fail(ErrorCode::input_unreadable, "{}: is not what 'rfsmooth tiles settle' writes: {}", path.string(),
         io::said_of(error));
  }
}

}  // namespace rfsmooth::pipeline::tiles
