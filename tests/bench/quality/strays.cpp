/// How well planted strays are told from the points of the surface.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/parallel.h"
#include "pipeline/outliers.h"
#include "rfs_mesh/points.h"
#include "tests/bench/quality/goals.h"

namespace rfsmooth::bench {
namespace {

/// Of planted points, those that no rule could tell from noise are counted apart: within six standard
/// deviations of the surface or four spacings.
struct Strays {
  std::size_t surface = 0, wrong = 0, planted = 0, found = 0, away = 0, found_away = 0;
};

void add(const Case& one, const Truth& truth, int threads, Strays& tally) {
  Context context;
  context.threads = threads;
  const auto cloud =
      rfs_mesh::make_working_cloud(one.noisy.data()->data(), one.noisy.size(), context).value();
  std::vector<char> outlier;
  in_arena(context, [&] { outlier = pipeline::find_outliers(cloud.points, context); });
  const double near = std::max(6 * one.noise.sigma, 4 * one.truth->spacing);
  for (std::size_t row = 0; row < one.noisy.size(); ++row) {
    const auto flag = std::size_t(outlier[cloud.of_input[row]]);
    if (!one.planted(row)) {
      ++tally.surface;
      tally.wrong += flag;
      continue;
    }
    const bool away = truth.surface().nearest(one.noisy[row]).squared > near * near;
    ++tally.planted;
    tally.found += flag;
    tally.away += std::size_t(away);
    tally.found_away += away ? flag : 0;
  }
}

}  // namespace

void print_outliers(const Plan& plan, Cases& cases) {
  std::vector<Noise> noises = plan.noises;
  noises.insert(noises.begin(), {NoiseKind::gaussian, 0, 0});
  for (const std::size_t size : plan.sizes)
    for (const auto& noise : noises) {
      Strays tally;
      for (const auto& shape : plan.shapes)
        add(cases.make(shape, size, noise), cases.truth(shape, size), plan.threads, tally);
      std::printf("  outliers, %zu points, %s: %zu of %zu points of the surface called one", size,
                  noise.name().c_str(), tally.wrong, tally.surface);
      if (tally.planted > 0)
        std::printf("; precision %.3f, recall %.3f; of those beyond 6 sigma and 4 spacings %.3f",
                    double(tally.found) / double(std::max<std::size_t>(1, tally.found + tally.wrong)),
                    double(tally.found) / double(tally.planted),
                    double(tally.found_away) / double(std::max<std::size_t>(1, tally.away)));
      std::printf("\n");
    }
}

}  // namespace rfsmooth::bench
