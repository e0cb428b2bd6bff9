// The accuracy and time of the default on development clouds, one line a cloud: shape, noise in per cent,
// Chamfer distance, mean square distance to the surface (both x 1e4 on the unit sphere), processor seconds.
// sensitivity.py runs it.
#include <cstdio>
#include <ctime>

#include <CLI/CLI.hpp>

#include "tests/bench/quality/data/dataset.h"
#include "tests/bench/quality/data/measure.h"
#include "tests/bench/quality/ours.h"

namespace rfsmooth::bench {

namespace {

void run(const std::string& shape, std::size_t points, const std::vector<double>& noise) {
  const auto sample = load_sample(shape, points, default_cache());
  const Truth truth(sample);
  for (const double percent : noise) {
    Noise added;
    added.sigma = percent / 100;
    const Case noisy = make_case(sample, added);
    const std::clock_t start = std::clock();
    const OurResult ours = run_ours(noisy.noisy, {"ours", {}}, 1);
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    const Measures m = truth.measure(ours.points, {}, {});
    std::printf("%s %g %.6g %.6g %.3f\n", shape.c_str(), percent, 1e4 * m.chamfer, 1e4 * m.p2s, seconds);
  }
}

}  // namespace

}  // namespace rfsmooth::bench

int main(int argc, char** argv) {
  CLI::App app("accuracy of the default on development clouds, for sensitivity.py");
  std::vector<std::string> shapes = rfsmooth::bench::shape_names();
  std::size_t points = 10000;
  std::vector<double> noise{1, 2, 3};
  app.add_option("--shapes", shapes, "development shapes")->delimiter(',');
  app.add_option("--points", points, "points of each");
  app.add_option("--noise", noise, "per cent of the radius")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  for (const std::string& shape : shapes) rfsmooth::bench::run(shape, points, noise);
  return 0;
}
