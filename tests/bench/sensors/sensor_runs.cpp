#include "tests/bench/sensors/sensor_runs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/bench/quality/runs.h"
#include "tests/bench/support/median.h"

namespace rfsmooth::bench {
namespace {

Positions as_files_hold(const Positions& points) {
  Positions rounded;
  for (const Eigen::Vector3d& p : points) rounded.emplace_back(p.cast<float>().cast<double>());
  return rounded;
}

double root_mean_square(const std::vector<double>& values) {
  double squares = 0;
  for (const double v : values) squares += v * v;
  return values.empty() ? 0 : std::sqrt(squares / double(values.size()));
}

bool is_near(const Eigen::Vector3d& truth) {
  return truth.norm() < kNear;
}

Distances distances(const clouds::Sensor& sensor, const Positions& truth, const peers::Smoothed& cloud) {
  std::vector<double> all, near;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const double distance = clouds::distance(clouds::room_of(sensor), cloud.points[i]);
    all.push_back(distance < kFar ? distance : kFar);  // what is no number is far, too
    if (is_near(truth[cloud.source.empty() ? i : cloud.source[i]])) near.push_back(all.back());
  }
  return {root_mean_square(all), median(all), root_mean_square(near)};
}

}  // namespace

SensorRow measure_sensor(const SensorPlan& plan, const clouds::Sensor& sensor) {
  const clouds::Sight sight = clouds::look(sensor, plan.seed);
  const Positions measured = as_files_hold(sight.measured);
  const auto first = run_ours(measured, plan.ours, plan.threads);
  SensorRow row;
  row.points = measured.size();
  row.near_share =
      double(std::count_if(sight.truth.begin(), sight.truth.end(), is_near)) / double(measured.size());
  row.seconds = first.seconds;
  row.noise = first.report.noise;
  row.left = first.report.noise_left.value_or(first.report.noise);
  row.raw = distances(sensor, sight.truth, {measured, {}});
  row.ours = distances(sensor, sight.truth, {first.points, {}});
  for (const char* const setting : {kFixedMls, kFixedJet}) {
    try {
      row.peers[setting] =
          distances(sensor, sight.truth, peer_result(plan.cache, measured, setting, plan.threads));
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s: %s: failed: %s\n", std::string(sensor.name).c_str(), setting, e.what());
    }
  }
  return row;
}

}  // namespace rfsmooth::bench
