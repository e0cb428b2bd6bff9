/// `rfsmooth::pcl::Denoise` beside `pcl::MovingLeastSquares`, both called as a PCL user calls them, in one
/// run: error against the true surface, time, memory (../README.md).
#include <algorithm>
#include <cstdio>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

#include <rfsmooth/pcl/denoise.h>

#include "tests/bench/quality/data/dataset.h"
#include "tests/bench/quality/data/measure.h"
#include "tests/bench/support/apart.h"
#include "tests/bench/support/main.h"

namespace {

using namespace rfsmooth::bench;
using rfsmooth::Index;
using rfsmooth::Positions;
using Cloud = ::pcl::PointCloud<::pcl::PointXYZ>;

Cloud::Ptr to_pcl(const Positions& points) {
  Cloud::Ptr cloud(new Cloud);
  for (const auto& p : points) cloud->push_back({float(p[0]), float(p[1]), float(p[2])});
  return cloud;
}

/// What a run says of itself: lengths on the unit sphere.
struct Row {
  Cost cost;
  double chamfer = 0, p2s = 0, worst = 0;
};

/// A tool: takes the input, fills the output and the input row of each of its points (empty = as the input).
struct Tool {
  std::string name;
  std::function<void(const Cloud::Ptr& in, double spacing, int threads, Cloud& out,
                     std::vector<Index>& source)>
      run;
};

Tool denoise_tool() {
  return {"Denoise", [](const Cloud::Ptr& in, double, int threads, Cloud& out, std::vector<Index>&) {
            rfsmooth::pcl::Denoise<::pcl::PointXYZ> denoise;
            denoise.setNumberOfThreads(unsigned(threads));
            denoise.setInputCloud(in);
            denoise.filter(out);
          }};
}

/// Order 2 within `radius` spacings. The spacing is that of the clean cloud: a user would have to guess it.
Tool mls_tool(double radius) {
  char name[64];
  std::snprintf(name, sizeof name, "MovingLeastSquares, %g spacings", radius);
  return {name, [radius](const Cloud::Ptr& in, double spacing, int threads, Cloud& out,
                         std::vector<Index>& source) {
            ::pcl::MovingLeastSquares<::pcl::PointXYZ, ::pcl::PointXYZ> mls;
            mls.setInputCloud(in);
            mls.setSearchMethod(std::make_shared<::pcl::search::KdTree<::pcl::PointXYZ>>());
            mls.setPolynomialOrder(2);
            mls.setSearchRadius(radius * spacing);
            mls.setNumberOfThreads(unsigned(threads));
            mls.process(out);
            for (const auto row : mls.getCorrespondingIndices()->indices) source.push_back(Index(row));
          }};
}

Row run(const Tool& tool, const std::string& shape, std::size_t n, double noise, int threads) {
  const Apart apart = run_apart([&](const Measure& measure) {
    const auto sample = load_sample(shape, n, default_cache());
    const Case data = make_case(sample, {NoiseKind::gaussian, noise, 0});
    const Cloud::Ptr in = to_pcl(data.noisy);
    Cloud out;
    std::vector<Index> source;
    measure([&] { tool.run(in, sample->spacing, threads, out, source); });
    Positions points;
    for (const auto& p : out) points.emplace_back(p.x, p.y, p.z);
    const Measures m = Truth(sample).measure(points, source, {});
    std::ostringstream said;
    said << m.chamfer << ' ' << m.p2s << ' ' << m.p2s_max;
    return said.str();
  });
  Row row;
  row.cost = apart.cost;
  std::istringstream(apart.said) >> row.chamfer >> row.p2s >> row.worst;
  return row;
}

void table(const std::vector<Tool>& tools, const std::vector<std::string>& shapes, std::size_t n,
           double noise, int threads) {
  std::printf("\n%zu points, noise %g %%, means over %zu shapes\n", n, 100 * noise, shapes.size());
  std::printf("  %-34s %9s %9s %9s %9s %9s %9s\n", "", "CD x1e4", "p2s x1e4", "worst", "wall s", "CPU s",
              "bytes/pt");
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<Row> means(tools.size());
  std::vector<double> best_p2s(shapes.size(), inf), best_chamfer(shapes.size(), inf), own(shapes.size());
  for (std::size_t s = 0; s < shapes.size(); ++s)
    for (std::size_t t = 0; t < tools.size(); ++t) {
      const Row row = run(tools[t], shapes[s], n, noise, threads);
      const double share = 1 / double(shapes.size());
      means[t].chamfer += share * row.chamfer;
      means[t].p2s += share * row.p2s;
      means[t].worst = std::max(means[t].worst, row.worst);
      means[t].cost.seconds += share * row.cost.seconds;
      means[t].cost.cpu += share * row.cost.cpu;
      means[t].cost.bytes = std::max(means[t].cost.bytes, row.cost.bytes);
      if (t == 0) continue;
      best_p2s[s] = std::min(best_p2s[s], row.p2s);
      best_chamfer[s] = std::min(best_chamfer[s], row.chamfer);
    }
  for (std::size_t t = 0; t < tools.size(); ++t)
    std::printf("  %-34s %9.3f %9.3f %9.4f %9.2f %9.2f %9.0f\n", tools[t].name.c_str(),
                1e4 * means[t].chamfer, 1e4 * means[t].p2s, means[t].worst, means[t].cost.seconds,
                means[t].cost.cpu, means[t].cost.bytes / double(n));
  double p2s = 0, chamfer = 0;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    p2s += best_p2s[s] / double(shapes.size());
    chamfer += best_chamfer[s] / double(shapes.size());
  }
  std::printf("  %-34s %9.3f %9.3f\n", "MovingLeastSquares, best per shape", 1e4 * chamfer, 1e4 * p2s);
  std::printf("  Denoise / that: CD %.2f, p2s %.2f\n", means[0].chamfer / chamfer, means[0].p2s / p2s);
  std::fflush(stdout);
}

int run_all(int argc, char** argv) {
  std::vector<std::size_t> sizes = {10000, 50000};
  std::vector<double> percent = {1, 2, 3}, radii = {2, 3, 4, 6, 9};
  std::vector<std::string> shapes = shape_names();
  int threads = 1;
  CLI::App app{"rfsmooth::pcl::Denoise beside pcl::MovingLeastSquares: error, time, memory"};
  app.add_option("--sizes", sizes)->capture_default_str();
  app.add_option("--noise", percent, "% of the bounding sphere's radius")->capture_default_str();
  app.add_option("--shapes", shapes)->capture_default_str();
  app.add_option("--radii", radii, "search radii of MovingLeastSquares, x spacing")->capture_default_str();
  app.add_option("--threads", threads)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::vector<Tool> tools = {denoise_tool()};
  for (const double radius : radii) tools.push_back(mls_tool(radius));
  for (const std::size_t n : sizes)
    for (const double p : percent) table(tools, shapes, n, p / 100, threads);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return tell_failures("pcl_stage", run_all, argc, argv);
}
