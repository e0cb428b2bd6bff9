#include "pipeline/tiles/steps/status.h"

#include <algorithm>
#include <cmath>

#include "pipeline/tiles/steps/measure.h"
#include "pipeline/tiles/steps/run.h"
#include "pipeline/tiles/steps/settle.h"

namespace rfsmooth::pipeline::tiles {

JobStatus job_status(const Job& job, const Context& context) {
  JobStatus status;
  status.tiles = job.tiles.size();
  status.points = job.points;
  double around = 0, within = 0;
  status.settled = is_settled(job);
  if (status.settled) status.halo = settled_of(job).halo;
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    status.measured += std::size_t(is_measured(job, t, context));
    if (!is_run(job, t, false, context)) {
      status.missing.push_back(t);
      continue;
    }
    ++status.run;
    const nlohmann::ordered_json cost = read_cost(job, t);
    if (cost.empty()) continue;
    around += cost.value("around", 0.0);
    within += double(job.tiles[t].points);
    status.seconds += cost.value("seconds", 0.0);
  }
  if (within > 0) status.halo_share = around / within;
  return status;
}

DenoiseReport report_of(const Job& job, const DenoiseOptions& options) {
  DenoiseReport report = settled_of(job).report;
  report.effective = options;
  report.points = std::size_t(job.rows());
  report.finite = std::size_t(job.points);
  double squares = 0;
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    const nlohmann::ordered_json cost = read_cost(job, t);
    report.moved += cost.value("moved", std::size_t{0});
    report.outliers += cost.value("outliers", std::size_t{0});
    report.largest_move = std::max(report.largest_move, cost.value("largest", 0.0));
    squares += cost.value("squares", 0.0);
  }
  if (report.finite > 0) report.rms_move = std::sqrt(squares / double(report.finite));
  return report;
}

}  // namespace rfsmooth::pipeline::tiles
