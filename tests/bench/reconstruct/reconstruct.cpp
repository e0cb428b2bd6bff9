/// The reconstruction benchmark: meshes from the raw cloud, from the cloud after the best peer and from ours,
/// by the same methods with the same normals and the same cleaning up (../README.md).
#include <algorithm>
#include <cstdio>
#include <map>

#include <CLI/CLI.hpp>

#include <rfsmooth/cgal/advancing_front.h>
#include <rfsmooth/open3d/surface.h>
#include <rfsmooth/reconstruct.h>

#include "pipeline/surface/topology.h"
#include "tests/bench/quality/ours.h"
#include "tests/bench/quality/runs.h"
#include "tests/bench/reconstruct/surface_error.h"
#include "tests/bench/support/main.h"

namespace {

using namespace rfsmooth;
using namespace rfsmooth::bench;

struct Cloud {
  std::string name;
  Positions points;
};

struct Made {
  Topology topology;
  SurfaceError error;
};

/// CGAL's front as CGAL gives it.
SurfaceMethod bare_front() {
  return {"front as it comes", false, [](const SurfaceInput& input, const Context& context) {
            return cgal::advancing_front(input.points, {}, 0, context);
          }};
}

/// The setting of a peer with the least mean squared distance to the true surface over all shapes of the
/// cell, as the quality benchmark picks it: with the truth in hand.
std::string best_of_cell(const Cell& cell, std::size_t shapes) {
  std::string best;
  double least = 0;
  for (const auto& [setting, rows] : cell) {
    if (rows.size() < shapes) continue;
    double sum = 0;
    for (const auto& [shape, row] : rows) sum += row.measures.p2s;
    if (best.empty() || sum < least) {
      least = sum;
      best = setting;
    }
  }
  if (best.empty())
    throw std::runtime_error("no peer's results in the cache: run `quality --peers-only` first");
  return best;
}

/// The same for one shape alone: stricter.
std::string best_of_shape(const Cell& cell, const std::string& shape) {
  std::string best;
  double least = 0;
  for (const auto& [setting, rows] : cell)
    if (const auto row = rows.find(shape);
        row != rows.end() && (best.empty() || row->second.measures.p2s < least)) {
      least = row->second.measures.p2s;
      best = setting;
    }
  return best;
}

Made make(const Cloud& cloud, const SurfaceMethod& method, bool bare, const Mesh& truth,
          const Context& context) {
  ReconstructOptions options;
  options.denoise = false;
  if (bare) options.fill_holes.value = 0;
  const auto* xyz = cloud.points.data()->data();
  auto made = rfsmooth::reconstruct({xyz, xyz + 3 * cloud.points.size()}, options, method, context);
  if (!made.ok()) throw std::runtime_error(made.error().message);
  return {made.value().report.topology, surface_error(made.value().mesh, truth, 100000, context)};
}

void print(const std::string& cloud, const Made& made) {
  const Topology& t = made.topology;
  std::printf("    %-24s %7.3f %7.3f %6zu %6zu %6zu %6zu %6ld %s\n", cloud.c_str(), 1e4 * made.error.to_truth,
              1e4 * made.error.from_truth, t.components, t.boundary_edges, t.boundary_loops,
              t.crowded_edges + t.pinched_vertices + t.disagreeing_edges, t.genus,
              t.closed_manifold() ? "closed manifold" : "");
}

/// Per method: what the marks are read from.
struct Tally {
  double ours = 0, cell_peers = 0, shape_peers = 0, cell_ratios = 0, shape_ratios = 0;
  std::size_t cells = 0, within = 0, closed = 0, raw_loops = 0;
  std::vector<std::string> open;
};

int run(int argc, char** argv) {
  Plan plan;
  plan.cache = default_cache();
  plan.threads = 2;
  plan.shapes = {"anchor_dense", "rotor", "armadillo", "hand",   "femur",
                 "knot1",        "cube",  "l-part",    "sphere", "torus"};
  plan.sizes = {10000, 50000};
  double percent = 2;
  std::vector<std::string> only;
  CLI::App app{"surfaces from raw, peers' and rfsmooth's clouds on the closed development shapes"};
  app.add_option("--cache", plan.cache, "folder of samples and peers' results")->capture_default_str();
  app.add_option("--threads", plan.threads, "for every tool")->capture_default_str();
  app.add_option("--shapes", plan.shapes, "only these");
  app.add_option("--sizes", plan.sizes, "numbers of points")->capture_default_str();
  app.add_option("--noise", percent, "Gaussian noise, % of the radius")->capture_default_str();
  app.add_option("--methods", only, "only these");
  CLI11_PARSE(app, argc, argv);

  Context context;
  context.threads = plan.threads;
  std::vector<SurfaceMethod> methods = open3d::surface_methods();
  methods.push_back(bare_front());
  methods.push_back(cgal::advancing_front_method());
  if (!only.empty())
    methods.erase(std::remove_if(methods.begin(), methods.end(),
                                 [&](const auto& m) {
                                   return std::find(only.begin(), only.end(), m.name) == only.end();
                                 }),
                  methods.end());
  const Store store(plan.cache / "peers");
  Cases cases(plan);
  std::map<std::string, Tally> tallies;
  for (const std::size_t size : plan.sizes) {
    const Noise noise{NoiseKind::gaussian, percent / 100, 0};
    const Cell cell = cached_peers(plan, cases, size, noise);
    const std::string of_cell = best_of_cell(cell, plan.shapes.size());
    for (const std::string& shape : plan.shapes) {
      const Case one = cases.make(shape, size, noise);
      const auto input = hash_points(one.noisy);
      const std::string of_shape = best_of_shape(cell, shape);
      const Mesh& truth = one.truth->mesh;
      const std::vector<Cloud> clouds = {
          {"raw", one.noisy},
          {of_cell, store.cloud(input, of_cell).value().points},
          {of_shape, store.cloud(input, of_shape).value().points},
          {"rfsmooth", run_ours(one.noisy, {"rfsmooth", {}}, plan.threads).points}};
      std::printf("\n%s, genus %ld\n  %-26s %7s %7s %6s %6s %6s %6s %6s\n", one.name.c_str(),
                  pipeline::topology(truth.positions.size(), truth.faces).genus, "", "to", "from", "pieces",
                  "rim", "holes", "flaws", "genus");
      for (const auto& method : methods) {
        const bool bare = method.name == bare_front().name;
        std::printf("  %s\n", method.name.c_str());
        Tally& tally = tallies[method.name];
        std::vector<Made> made;
        for (std::size_t k = 0; k < clouds.size(); ++k) {
          const bool again = k == 2 && of_shape == of_cell;
          made.push_back(again ? made[1] : make(clouds[k], method, bare, truth, context));
          if (!again) print(clouds[k].name, made.back());
        }
        const double ours = made[3].error.both(), cell_peer = made[1].error.both(),
                     shape_peer = made[2].error.both();
        std::printf("    %-24s %.2f (best peer of the cell), %.2f (of the shape)\n", "rfsmooth / peer",
                    ours / cell_peer, ours / shape_peer);
        std::fflush(stdout);
        tally.ours += ours;
        tally.cell_peers += cell_peer;
        tally.shape_peers += shape_peer;
        tally.cell_ratios += ours / cell_peer;
        tally.shape_ratios += ours / shape_peer;
        tally.within += ours <= 0.6 * cell_peer;
        ++tally.cells;
        tally.raw_loops += made[0].topology.boundary_loops;
        if (made[3].topology.closed_manifold() && made[3].topology.components == 1)
          ++tally.closed;
        else
          tally.open.push_back(one.name);
      }
    }
  }
  std::printf("\n%-20s %22s %22s\n%-20s %10s %11s %10s %11s %10s %10s %12s\n", "", "of the cell's peer",
              "of the shape's peer", "", "of means", "mean ratio", "of means", "mean ratio", "<= 0.6",
              "closed", "raw's holes");
  for (const auto& [name, tally] : tallies) {
    const auto cells = double(tally.cells);
    std::printf("%-20s %10.2f %11.2f %10.2f %11.2f %5zu / %2zu %5zu / %2zu %12.0f", name.c_str(),
                tally.ours / tally.cell_peers, tally.cell_ratios / cells, tally.ours / tally.shape_peers,
                tally.shape_ratios / cells, tally.within, tally.cells, tally.closed, tally.cells,
                double(tally.raw_loops) / cells);
    if (tally.closed > 0)
      for (const std::string& shape : tally.open) std::printf("; open: %s", shape.c_str());
    std::printf("\n");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return tell_failures("reconstruct", run, argc, argv);
}
