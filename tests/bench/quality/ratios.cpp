#include <algorithm>
#include <cstdio>

#include "tests/bench/quality/goals.h"

namespace rfsmooth::bench {
namespace {

/// Cells of one kind of noise and the limits of the mean ratio over them.
struct Group {
  const char* name;
  std::string tool;
  NoiseKind kind;
  bool outliers;
  double chamfer, p2s;
  bool strict;  ///< also: no ratio above 1, no shape above 1.05 of the best peer on it
  bool has(const Noise& noise) const {
    return noise.sigma > 0 && noise.kind == kind && (noise.outliers > 0) == outliers;
  }
};

/// Ratios of several cells, and which of them is worst.
struct Tally {
  double sum = 0, largest = 0;
  std::size_t cells = 0;
  Ratio worst, worst_fixed;
  std::string worst_cell, worst_fixed_cell;

  void add(const Ratio& r, const std::string& cell) {
    sum += r.of_means;
    largest = std::max(largest, r.of_means);
    ++cells;
    if (r.worst > worst.worst) {
      worst = r;
      worst_cell = cell;
    }
    if (r.worst_fixed > worst_fixed.worst_fixed) {
      worst_fixed = r;
      worst_fixed_cell = cell;
    }
  }
  double mean() const { return sum / double(cells); }
};

void print_group(const Plan& plan, const Results& results, const Group& group, Measure measure,
                 const char* name, double limit) {
  Tally tally;
  for (const std::size_t size : plan.sizes)
    for (const auto& noise : plan.noises) {
      const auto found = results.find({noise.name(), size});
      if (found == results.end() || !group.has(noise) || found->second.count(group.tool) == 0) continue;
      if (tally.cells == 0) std::printf("\n  %s, %s, %s\n", group.tool.c_str(), group.name, name);
      const Best best = best_peer(found->second, plan.shapes, measure);
      if (best.setting.empty()) {
        std::printf("    %6zu %-24s not measured: no peer setting has every shape yet\n", size,
                    noise.name().c_str());
        continue;
      }
      const Ratio r = compare(found->second, group.tool, plan.shapes, measure);
      std::printf("    %6zu %-24s %.3f   (%s)   worst shape %.3f on %s\n", size, noise.name().c_str(),
                  r.of_means, best.setting.c_str(), r.worst, r.worst_shape.c_str());
      tally.add(r, std::to_string(size) + " " + noise.name());
    }
  if (tally.cells == 0) return;
  std::printf("    mean of %zu ratios %.3f, at most %.2f: %s\n", tally.cells, tally.mean(), limit,
              verdict(tally.mean() <= limit));
  if (!group.strict) return;
  std::printf("    largest ratio %.3f, at most 1: %s\n", tally.largest, verdict(tally.largest <= 1));
  std::printf("    worst shape %.3f on %s, %s (best on it: %s), at most 1.05: %s\n", tally.worst.worst,
              tally.worst.worst_shape.c_str(), tally.worst_cell.c_str(), tally.worst.worst_peer.c_str(),
              verdict(tally.worst.worst <= 1.05));
  std::printf("    worst shape against the one setting that is best for its cell: %.3f on %s, %s\n",
              tally.worst_fixed.worst_fixed, tally.worst_fixed.worst_fixed_shape.c_str(),
              tally.worst_fixed_cell.c_str());
}

void print_edges(const Plan& plan, const Results& results, const std::string& ours) {
  std::vector<std::string> sharp;
  for (const auto& shape : sharp_shapes())
    if (std::find(plan.shapes.begin(), plan.shapes.end(), shape) != plan.shapes.end()) sharp.push_back(shape);
  if (sharp.empty()) return;
  std::printf(
      "\n  %s at edges: p2s of the points within two spacings of an edge of 40 degrees or more, %zu shapes\n",
      ours.c_str(), sharp.size());
  Tally tally;
  for (const std::size_t size : plan.sizes)
    for (const auto& noise : plan.noises) {
      const auto found = results.find({noise.name(), size});
      if (found == results.end() || noise.sigma == 0 || found->second.count(ours) == 0) continue;
      const Best best = best_peer(found->second, sharp, Measure::edge_p2s);
      if (best.setting.empty()) continue;
      const Ratio r = compare(found->second, ours, sharp, Measure::edge_p2s);
      std::printf("    %6zu %-24s %.3f   (%s)  ", size, noise.name().c_str(), r.of_means,
                  best.setting.c_str());
      for (const auto& shape : sharp)
        std::printf(" %s %.2f", shape.c_str(),
                    compare(found->second, ours, {shape}, Measure::edge_p2s).of_means);
      std::printf("\n");
      if (noise.kind == NoiseKind::gaussian && noise.outliers == 0) tally.add(r, "");
    }
  if (tally.cells > 0)
    std::printf("    mean of the %zu Gaussian ratios %.3f, at most 0.7: %s\n", tally.cells, tally.mean(),
                verdict(tally.mean() <= 0.7));
}

}  // namespace

void print_ratios(const Plan& plan, const Results& results, const std::string& ours,
                  const std::string& without_equalizing) {
  std::printf(
      "\nRatios of means to the best peer setting of each cell (chosen with the truth, per measure)\n");
  const std::vector<Group> groups = {
      {"Gaussian", ours, NoiseKind::gaussian, false, 0.78, 0.55, true},
      {"Gaussian", without_equalizing, NoiseKind::gaussian, false, 0.9, 0.55, false},
      {"along the ray", ours, NoiseKind::ray, false, 0.8, 0.6, false},
      {"outliers", ours, NoiseKind::gaussian, true, 0.8, 0.6, false},
  };
  for (const auto& group : groups) {
    print_group(plan, results, group, Measure::chamfer, "CD", group.chamfer);
    print_group(plan, results, group, Measure::p2s, "p2s", group.p2s);
  }
  print_edges(plan, results, ours);
}

}  // namespace rfsmooth::bench
