// What the default makes of development clouds, for sensitivity.py, a line each: kind, shape, cloud,
// processor seconds and the figures of that cloud. Clouds under a law of noise have their Chamfer distance
// and mean square distance to the surface (squared spacings); "normals" the mean angle to the true normal, a
// wrong side included (degrees); "strays" the points judged wrongly over those planted; of others see
// further.h.
#include <algorithm>
#include <random>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>

#include "tests/bench/quality/data/measure.h"
#include "tests/bench/quality/law_runs.h"
#include "tests/bench/sensitivity/angles.h"
#include "tests/bench/sensitivity/further.h"
#include "tests/bench/sensitivity/rows.h"

namespace {

using namespace rfsmooth::bench;
using rfsmooth::Positions;

constexpr double kPlanted = 0.01;  // of the points
constexpr double kAway = 4;        // spacings: nearer to the surface, nobody can tell a stray from noise

Positions denoised(const LawPlan& plan, const std::string& shape, const LawCase& one, const Truth& truth) {
  const double unit = 1 / (one.truth->spacing * one.truth->spacing);
  const Stopwatch watch;
  const OurResult ours = run_ours(one.cloud.measured, plan.ours, 1);
  const double seconds = watch.seconds();
  const Measures m = truth.measure(ours.points, {}, {});
  const std::string law = one.name.substr(0, one.name.find(' '));
  print_row("laws", shape, times_as_loud(law, plan.times), seconds, {unit * m.chamfer, unit * m.p2s});
  return ours.points;
}

void normals(const std::string& shape, const Positions& points, const Truth& truth) {
  const Angles angles = angles_of_normals(points, {}, true_normals(truth, points));
  print_row("normals", shape, "normals", angles.seconds, {angles.mean});
}

void strays(const LawPlan& plan, const std::string& shape, const LawCase& one, const Truth& truth) {
  Positions points = one.cloud.measured;
  Eigen::AlignedBox<double, 3> box;
  for (const auto& p : points) box.extend(p);
  std::mt19937 random(1);
  const std::size_t n = points.size(), planted = std::size_t(kPlanted * double(n));
  const double away = kAway * one.truth->spacing;
  while (points.size() < n + planted) {
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = box.min()[axis] + box.sizes()[axis] * double(random()) / double(std::mt19937::max());
    if (truth.surface().nearest(p).squared > away * away) points.push_back(p);
  }
  const Stopwatch watch;
  const OurResult ours = run_ours(points, plan.ours, 1);
  const double seconds = watch.seconds();
  const std::vector<char>& outlier = ours.report.outlier;
  std::size_t wrong = outlier.empty() ? planted : 0;
  for (std::size_t i = 0; i < outlier.size(); ++i) wrong += (outlier[i] != 0) != (i >= n) ? 1 : 0;
  print_row("strays", shape, "strays", seconds, {double(wrong) / double(planted)});
}

void print_laws(LawPlan plan, std::size_t points, const std::vector<double>& times) {
  for (const std::string& shape : plan.shapes)
    for (const std::string& law : plan.laws)
      for (const double factor : times) {
        if (law != plan.laws.front() && factor != times.front()) continue;
        plan.times = factor;
        const LawCase one = make_law_case(plan, law, shape, points);
        const Truth truth(one.truth);
        const Positions smooth = denoised(plan, shape, one, truth);
        if (law != plan.laws.front() || factor != times.front()) continue;
        normals(shape, smooth, truth);
        strays(plan, shape, one, truth);
      }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("accuracy of the default on development clouds, for sensitivity.py");
  LawPlan plan;
  plan.cache = default_cache();
  plan.shapes = {"rotor", "hand", "anchor_dense"};
  plan.laws = {"white", "tails5", "correlated7", "half"};
  std::size_t points = 3000;
  std::vector<double> times{1, 3};
  const std::vector<std::string> all{"laws", "further", "normals", "surfaces"};
  std::vector<std::string> parts = all;
  app.add_option("--parts", parts, "laws: with normals and strays; what the others are: further.h")
      ->delimiter(',')
      ->check(CLI::IsMember(all));
  app.add_option("--shapes", plan.shapes, "development shapes")->delimiter(',');
  app.add_option("--laws", plan.laws, "of noise; normals and strays are judged under the first")
      ->delimiter(',');
  app.add_option("--points", points, "points of each");
  app.add_option("--times", times,
                 "the noise of the first law, x what its row says; the others run at the first")
      ->delimiter(',');
  app.add_option("--cache", plan.cache, "folder of the samples");
  CLI11_PARSE(app, argc, argv);
  for (const std::string& part : parts) {
    if (part == "laws") print_laws(plan, points, times);
    if (part == "further") print_further(plan, points);
    if (part == "normals") print_further_normals(plan);
    if (part == "surfaces") print_surfaces(plan, points);
  }
  return 0;
}
