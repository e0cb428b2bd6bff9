// The accuracy and time of the default on development clouds under laws of real noise, one line a cloud:
// shape, law and noise, Chamfer distance and mean square distance to the surface (both in squared spacings),
// processor seconds. sensitivity.py runs it.
#include <cstdio>
#include <ctime>

#include <CLI/CLI.hpp>

#include "tests/bench/quality/data/dataset.h"
#include "tests/bench/quality/data/measure.h"
#include "tests/bench/quality/law_runs.h"

namespace {

using namespace rfsmooth::bench;

void run(const LawPlan& plan, const std::string& law, const std::string& shape, std::size_t points) {
  const LawCase one = make_law_case(plan, law, shape, points);
  const Truth truth(one.truth);
  const double unit = 1 / (one.truth->spacing * one.truth->spacing);
  const std::clock_t start = std::clock();
  const OurResult ours = run_ours(one.cloud.measured, plan.ours, 1);
  const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
  const Measures m = truth.measure(ours.points, {}, {});
  std::printf("%s %s*%g %.6g %.6g %.3f\n", shape.c_str(), law.c_str(), plan.times, unit * m.chamfer,
              unit * m.p2s, seconds);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("accuracy of the default on development clouds, for sensitivity.py");
  LawPlan plan;
  plan.cache = default_cache();
  plan.shapes = {"rotor", "hand", "anchor_dense"};
  plan.laws = {"white", "tails5", "correlated7", "half"};
  std::size_t points = 5000;
  std::vector<double> times{1, 3};
  app.add_option("--shapes", plan.shapes, "development shapes")->delimiter(',');
  app.add_option("--laws", plan.laws, "of noise")->delimiter(',');
  app.add_option("--points", points, "points of each");
  app.add_option("--times", times,
                 "the noise of the first law, x what its row says; the others run at the first")
      ->delimiter(',');
  app.add_option("--cache", plan.cache, "folder of the samples");
  CLI11_PARSE(app, argc, argv);
  for (const std::string& shape : plan.shapes)
    for (const std::string& law : plan.laws)
      for (const double factor : times) {
        if (law != plan.laws.front() && factor != times.front()) continue;
        plan.times = factor;
        run(plan, law, shape, points);
      }
  return 0;
}
