/// The reconstruction benchmark: meshes from the raw cloud, from the cloud after the best peer and from ours,
/// by the same methods with the same normals and the same cleaning up (../README.md).
#include "rfsmooth/pipeline/reconstruct.h"

#include <cstdio>
#include <exception>
#include <map>

#include <CLI/CLI.hpp>

#include "rfsmooth/cgal/advancing_front.h"
#include "rfsmooth/open3d/surface.h"

#include "ours.h"
#include "runs.h"
#include "surface_error.h"

namespace {

using namespace rfsmooth;
using namespace rfsmooth::bench;

struct Cloud {
  std::string name;
  Positions points;
};

struct Made {
  pipeline::Topology topology;
  SurfaceError error;
};

/// CGAL's front as CGAL gives it.
pipeline::SurfaceMethod bare_front() {
  return {"front as it comes", false, [](const pipeline::SurfaceInput& input, const Context& context) {
            return cgal::advancing_front(input.points, {}, 0, context);
          }};
}

/// The peer's result nearest to the true surface, chosen for this very cloud with the truth in hand.
Cloud best_peer(const Store& store, std::uint64_t input) {
  Cloud best;
  double least = 0;
  for (const auto& setting : peer_settings())
    if (const auto row = store.row(input, setting.name);
        row && (best.name.empty() || row->measures.p2s < least)) {
      least = row->measures.p2s;
      best.name = setting.name;
    }
  if (best.name.empty())
    throw std::runtime_error("no peer's result in the cache: run `quality --peers-only` first");
  best.points = store.cloud(input, best.name).value().points;
  return best;
}

Made make(const Cloud& cloud, const pipeline::SurfaceMethod& method, bool bare, const rfs_mesh::Mesh& truth,
          const Context& context) {
  pipeline::ReconstructOptions options;
  options.denoise = false;
  if (bare) options.fill_holes.value = 0;
  const auto* xyz = cloud.points.data()->data();
  auto made = pipeline::reconstruct({xyz, xyz + 3 * cloud.points.size()}, options, method, context);
  if (!made.ok()) throw std::runtime_error(made.error().message);
  return {made.value().report.topology, surface_error(made.value().mesh, truth, 100000, context)};
}

void print(const std::string& cloud, const Made& made) {
  const pipeline::Topology& t = made.topology;
  std::printf("    %-24s %7.3f %7.3f %6zu %6zu %6zu %6zu %6ld %s\n", cloud.c_str(), 1e4 * made.error.to_truth,
              1e4 * made.error.from_truth, t.components, t.boundary_edges, t.boundary_loops,
              t.crowded_edges + t.pinched_vertices + t.disagreeing_edges, t.genus,
              t.closed_manifold() ? "closed manifold" : "");
}

/// Per method: what the marks are read from.
struct Tally {
  double ratios = 0, ours = 0, peers = 0;
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
  CLI::App app{"surfaces from raw, peers' and rfsmooth's clouds on the closed development shapes"};
  app.add_option("--cache", plan.cache, "folder of samples and peers' results")->capture_default_str();
  app.add_option("--threads", plan.threads, "for every tool")->capture_default_str();
  app.add_option("--shapes", plan.shapes, "only these");
  app.add_option("--sizes", plan.sizes, "numbers of points")->capture_default_str();
  app.add_option("--noise", percent, "Gaussian noise, % of the radius")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  Context context;
  context.threads = plan.threads;
  std::vector<pipeline::SurfaceMethod> methods = open3d::surface_methods();
  methods.push_back(bare_front());
  methods.push_back(cgal::advancing_front_method());
  const Store store(plan.cache / "peers");
  Cases cases(plan);
  std::map<std::string, Tally> tallies;
  for (const std::size_t size : plan.sizes)
    for (const std::string& shape : plan.shapes) {
      const Case one = cases.make(shape, size, {NoiseKind::gaussian, percent / 100, 0});
      const rfs_mesh::Mesh& truth = one.truth->mesh;
      const std::vector<Cloud> clouds = {
          {"raw", one.noisy},
          best_peer(store, hash_points(one.noisy)),
          {"rfsmooth", run_ours(one.noisy, {"rfsmooth", {}}, plan.threads).points}};
      std::printf("\n%s, genus %ld\n  %-26s %7s %7s %6s %6s %6s %6s %6s\n", one.name.c_str(),
                  pipeline::topology(truth.positions.size(), truth.faces).genus, "", "to", "from", "pieces",
                  "rim", "holes", "flaws", "genus");
      for (const auto& method : methods) {
        const bool bare = method.name == bare_front().name;
        std::printf("  %s\n", method.name.c_str());
        Tally& tally = tallies[method.name];
        std::vector<Made> made;
        for (const Cloud& cloud : clouds) {
          made.push_back(make(cloud, method, bare, truth, context));
          print(cloud.name, made.back());
        }
        const double ours = made[2].error.both(), peer = made[1].error.both();
        std::printf("    %-24s %.2f\n", "rfsmooth / peer", ours / peer);
        std::fflush(stdout);
        tally.ratios += ours / peer;
        tally.ours += ours;
        tally.peers += peer;
        tally.within += ours <= 0.6 * peer;
        ++tally.cells;
        tally.raw_loops += made[0].topology.boundary_loops;
        if (made[2].topology.closed_manifold() && made[2].topology.components == 1)
          ++tally.closed;
        else
          tally.open.push_back(one.name);
      }
    }
  std::printf("\n%-20s %10s %10s %10s %10s %12s\n", "", "mean ratio", "of means", "<= 0.6", "closed",
              "raw's holes");
  for (const auto& [name, tally] : tallies) {
    std::printf("%-20s %10.2f %10.2f %5zu / %2zu %5zu / %2zu %12.0f", name.c_str(),
                tally.ratios / double(tally.cells), tally.ours / tally.peers, tally.within, tally.cells,
                tally.closed, tally.cells, double(tally.raw_loops) / double(tally.cells));
    if (tally.closed > 0)
      for (const std::string& shape : tally.open) std::printf("; open: %s", shape.c_str());
    std::printf("\n");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "reconstruct: %s\n", e.what());
    return 1;
  }
}
