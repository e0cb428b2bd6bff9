#include "tests/bench/quality/law_runs.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "base/parallel.h"
#include "clouds/shapes/sampling.h"

namespace rfsmooth::bench {
namespace {

constexpr std::uint64_t kSpreadSeed = 21, kLawSeed = 22;

/// The sample with its points where the law puts them.
std::shared_ptr<const Sample> spread_over(const std::shared_ptr<const Sample>& even, Positions points) {
  auto sample = std::make_shared<Sample>(*even);
  sample->spacing = clouds::mean_spacing(points);
  sample->clean = std::move(points);
  return sample;
}

bool is_wanted(const PeerSetting& setting, int most_tier) {
  return setting.tier <= most_tier || setting.name == kFixedMls || setting.name == kFixedJet;
}

/// Mean squared distance of a peer's result, from the store if it is there.
double peer_error(const Store& store, const LawPlan& plan, const LawCase& one, const Truth& truth,
                  const PeerSetting& setting) {
  const auto input = hash_points(one.cloud.measured);
  if (const auto known = store.row(input, setting.name)) return known->measures.p2s;
  Context context;
  context.threads = plan.threads;
  std::optional<peers::Smoothed> from;
  if (!setting.base.empty()) from = store.cloud(input, setting.base);
  const auto result = setting.run(from ? from->points : one.cloud.measured, plan.threads);
  Row row;
  row.threads = plan.threads;
  row.measures = truth.measure(result.points, result.source, context);
  store.save(input, setting.name, result, row);
  return row.measures.p2s;
}

void measure_peers(const LawPlan& plan, const LawCase& one, const Truth& truth, LawRow& row) {
  const Store store(plan.cache / "peers");
  const double unit = 1 / (one.truth->spacing * one.truth->spacing);
  for (const auto& setting : peer_settings()) {
    if (!is_wanted(setting, plan.most_tier)) continue;
    try {
      row.peers[setting.name] = unit * peer_error(store, plan, one, truth, setting);
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s: %s: failed: %s\n", one.name.c_str(), setting.name.c_str(), e.what());
    }
  }
}

/// How far the points went that were right where they were.
void measure_exact(const LawCase& one, const Positions& after, LawRow& row) {
  double squares = 0;
  std::size_t count = 0, far = 0;
  for (std::size_t i = 0; i < one.cloud.exact.size(); ++i) {
    if (one.cloud.exact[i] == 0) continue;
    const double moved = (after[i] - one.cloud.measured[i]).norm() / one.truth->spacing;
    squares += moved * moved;
    far += moved > 0.05;
    ++count;
  }
  if (count == 0) return;
  row.exact_moved = std::sqrt(squares / double(count));
  row.exact_share = double(far) / double(count);
}

double mean_squared(const ClosestTree& surface, const Positions& points, int threads) {
  Context context;
  context.threads = threads;
  double mean = 0;
  in_arena(context, [&] {
    mean = sum_over(context, points.size(), 0.0,
                    [&](std::size_t i) { return surface.nearest(points[i]).squared; }) /
           double(points.size());
  });
  return mean;
}

}  // namespace

LawCase make_law_case(const LawPlan& plan, const std::string& name, const std::string& shape,
                      std::size_t size) {
  const clouds::Law* known = clouds::find_law(name);
  if (known == nullptr) throw std::invalid_argument("no law is called \"" + name + "\"");
  const clouds::Law law = clouds::scaled(*known, plan.times);
  LawCase one;
  one.name = name + " " + shape + " " + std::to_string(size);
  one.truth = load_sample(shape, size, plan.cache);
  clouds::Spots spots{one.truth->clean, {}};
  if (law.spread != clouds::Spread::even) {
    spots = clouds::spread(law, one.truth->mesh, size, kSpreadSeed);
    one.truth = spread_over(one.truth, spots.points);
  }
  one.cloud = clouds::add_noise(law, spots, one.truth->spacing, kLawSeed);
  return one;
}

LawRow measure_law_case(const LawPlan& plan, const LawCase& one) {
  const Truth truth(one.truth);
  const double spacing = one.truth->spacing, unit = 1 / (spacing * spacing);
  const auto first = run_ours(one.cloud.measured, plan.ours, plan.threads);
  LawRow row;
  row.points = one.cloud.measured.size();
  row.seconds = first.seconds;
  row.raw = unit * mean_squared(truth.surface(), one.cloud.measured, plan.threads);
  row.ours = unit * mean_squared(truth.surface(), first.points, plan.threads);
  row.noise = first.report.noise / spacing;
  row.left = first.report.noise_left.value_or(first.report.noise) / spacing;
  measure_exact(one, first.points, row);
  if (plan.again) {
    const auto second = run_ours(first.points, plan.ours, plan.threads);
    const double moved = moves(one.cloud.measured, first.points).rms;
    if (moved > 0) row.again = moves(first.points, second.points).rms / moved;
  }
  measure_peers(plan, one, truth, row);
  return row;
}

}  // namespace rfsmooth::bench
