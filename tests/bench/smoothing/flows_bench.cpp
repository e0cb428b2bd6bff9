// The flow library's speed, in one run:
//
//   steps       one step of each explicit flow and implicit solves on a mesh of 1,000,000 vertices, in
//               units of a plain copy-and-gather (y_i = x_i + sum of the neighbours) over the same adjacency
//   desbrun     conjugate gradient iterations at dt = 10 and 100, first order, umbrella, by tolerance; beside
//               Desbrun et al. 1999, section 2.8 (5-9 and 28-39)
//   peers       time until the rms distance of a noisy sphere to the true one has fallen to 30 %:
//               Open3D's filters, CGAL's smooth_shape, ours; a Mesh comes with its adjacency, so both are
//               given: without and with building it (Open3D's call builds its own)
//
//   flows_bench [steps|desbrun|peers]      all three without an argument
//
// Every mesh is in random order first and then put in Morton order, as the pipeline hands points over. Noise
// is isotropic, 0.2 mean edge lengths per coordinate. Times are the least of several rounds.
#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <random>

#include <fmt/format.h>

#include <rfsmooth/flow.h>

#include "base/parallel.h"
#include "rfs_mesh/points.h"
#include "smoothing/integrators/solver.h"
#include "smoothing/operators/operator.h"
#include "tests/bench/peers/mesh_smoothing.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

constexpr double kNoise = 0.2;  // x mean edge

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double least(int rounds, const std::function<void()>& work) {
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < rounds; ++k) best = std::min(best, seconds(work));
  return best;
}

/// Shuffled, then in Morton order.
Mesh reordered(const Mesh& mesh) {
  std::vector<double> xyz;
  for (const Vector3d& p : mesh.positions) xyz.insert(xyz.end(), {p.x(), p.y(), p.z()});
  const auto cloud = rfs_mesh::make_working_cloud(xyz.data(), mesh.positions.size(), {}).value();
  Mesh ordered;
  ordered.positions = cloud.points;
  for (Vector3d& p : ordered.positions) p += cloud.origin;
  ordered.faces = mesh.faces;
  for (auto& f : ordered.faces)
    for (Index& v : f) v = cloud.of_input[v];
  std::shuffle(ordered.faces.begin(), ordered.faces.end(), std::mt19937_64(1));
  rebuild_adjacency(ordered, {});
  return ordered;
}

Mesh noisy(Mesh mesh) {
  support::add_noise(mesh, kNoise * support::mean_edge(mesh), 1);
  return reordered(mesh);
}

void steps() {
  const Mesh mesh = noisy(support::torus(1250, 800, 0.4));
  const Adjacency& rows = mesh.one_ring;
  const Context context;
  Positions out(mesh.positions.size());
  const auto gather = [&] {
    for_each_index(context, out.size(), [&](std::size_t i) {
      Vector3d sum = mesh.positions[i];
      for (const Index j : rows[i]) sum += mesh.positions[j];
      out[i] = sum;
    });
  };
  double unit = least(5, gather);
  /// The least time of `work`, with the unit measured between the rounds.
  const auto beside_gather = [&](int rounds, const std::function<void()>& work) {
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < rounds; ++k) {
      unit = std::min(unit, seconds(gather));
      best = std::min(best, seconds(work));
    }
    return best;
  };
  fmt::print("steps: {} vertices, {} edges; copy-and-gather {:.1f} ms\n", mesh.positions.size(),
             mesh.edge_count(), 1e3 * unit);
  for (const AnyFlow& any : flows()) {
    const std::string_view name = name_of(any);
    if (std::holds_alternative<AutomaticOptions>(any) || std::holds_alternative<ImplicitOptions>(any) ||
        std::holds_alternative<HcLimitOptions>(any) || std::holds_alternative<DiscreteFairingOptions>(any))
      continue;  // not explicit
    Mesh moving = mesh;
    const FlowOptions o{any};
    const auto flow = make_flow(moving, o, context);
    flow.value()->step(moving, context);
    const bool cheap = seconds([&] { flow.value()->step(moving, context); }) < 0.05;
    const double t = beside_gather(cheap ? 41 : 7, [&] { flow.value()->step(moving, context); });
    fmt::print("  {:20} {:8.1f} ms  {:6.2f} gathers\n", name, 1e3 * t, t / unit);
  }
  Mesh moving = mesh;
  const auto laplacian = make_flow(moving, {LaplacianOptions()}, context);
  laplacian.value()->step(moving, context);
  const double step = least(21, [&] { laplacian.value()->step(moving, context); });
  const Operator op = umbrella(mesh.one_ring, context);
  for (const int order : {1, 2}) {
    Fairing system{rows, op};
    system.a[std::size_t(order) - 1] = 10;
    SolverReport report;
    const double t = least(7, [&] {
      Positions x;
      report = solve(system, mesh.positions, x, {}, {}, context);
    });
    fmt::print("  implicit dt 10 order {} to 1e-5: {:.0f} ms, {} iterations, {:.1f} steps' worth\n", order,
               1e3 * t, report.iterations, t / step);
  }
}

void desbrun() {
  fmt::print("desbrun: iterations, first order umbrella, l2 (paper: 5-9 at dt 10, 28-39 at dt 100)\n");
  fmt::print("  {:>8} {:>10} {:>8} {:>8}\n", "faces", "tolerance", "dt 10", "dt 100");
  for (const auto& [around, along] : {std::pair(175, 120), std::pair(220, 150), std::pair(500, 290)}) {
    const Mesh mesh = noisy(support::torus(around, along, 0.4));
    const Operator op = umbrella(mesh.one_ring, {});
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5}) {
      int iterations[2];
      for (int k = 0; k < 2; ++k) {
        Fairing system{mesh.one_ring, op};
        system.a[0] = k == 0 ? 10 : 100;
        SolverOptions options;
        options.tolerance = tolerance;
        Positions x;
        iterations[k] = solve(system, mesh.positions, x, {}, options, {}).iterations;
      }
      fmt::print("  {:8} {:10.0e} {:8} {:8}\n", mesh.faces.size(), tolerance, iterations[0], iterations[1]);
    }
  }
}

double off_sphere(const std::vector<double>& xyz) {
  Positions x;
  for (std::size_t i = 0; i < xyz.size(); i += 3) x.emplace_back(xyz[i], xyz[i + 1], xyz[i + 2]);
  return support::rms_off_unit_sphere(x);
}

void beside_peers(int levels, bool cgal) {
  using namespace rfsmooth::bench::peers;
  const Mesh mesh = noisy(support::icosphere(levels));
  std::vector<double> xyz;
  for (const Vector3d& p : mesh.positions) xyz.insert(xyz.end(), {p.x(), p.y(), p.z()});
  std::vector<std::uint32_t> faces;
  for (const auto& f : mesh.faces) faces.insert(faces.end(), f.begin(), f.end());
  const std::size_t n = mesh.positions.size(), m = mesh.faces.size();
  const double goal = 0.3 * support::rms_off_unit_sphere(mesh.positions);
  fmt::print("peers: sphere of {} vertices, time to 30 % of the noise\n", n);
  double ours = std::numeric_limits<double>::infinity(), ours_connected = ours;

  ImplicitOptions by_time;
  by_time.tolerance = 1e-3;
  for (AnyFlow any : {AnyFlow(LaplacianOptions()), AnyFlow(TaubinOptions()), AnyFlow(HcOptions()),
                      AnyFlow(BilaplacianOptions()), AnyFlow(by_time)}) {
    const std::string_view name = name_of(any);
    auto* const implicit = std::get_if<ImplicitOptions>(&any);
    bool reached = false;
    for (const int count : {1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, 50}) {
      if (implicit != nullptr)
        implicit->dt = count;
      else
        iterations(any) = count;
      Mesh moving = mesh;
      const auto run = [&] { (void)smooth(moving, {any}, {}); };
      run();
      if (support::rms_off_unit_sphere(moving.positions) > goal) continue;
      const double connect = least(5, [&] { rebuild_adjacency(moving, {}); });
      double t = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 7; ++k) {
        moving.positions = mesh.positions;
        t = std::min(t, seconds(run));
      }
      ours = std::min(ours, t);
      ours_connected = std::min(ours_connected, t + connect);
      fmt::print("  rfsmooth {:12} {:4} {} {:9.2f} ms, {:.2f} with the adjacency\n", name,
                 implicit != nullptr ? "dt" : "", count, 1e3 * t, 1e3 * (t + connect));
      reached = true;
      break;
    }
    if (!reached) fmt::print("  rfsmooth {:12} does not reach it\n", name);
  }

  const auto peer = [&](const char* name, const std::vector<double>& settings, auto&& call) {
    for (const double setting : settings) {
      SmoothedMesh result = call(setting);
      if (!(off_sphere(result.xyz) <= goal)) continue;
      double t = result.seconds;
      for (int k = 0; k < 2; ++k) t = std::min(t, call(setting).seconds);
      fmt::print("  {:21} {:8g} {:9.1f} ms   {:6.1f} times ours ({:.1f} with the adjacency)\n", name, setting,
                 1e3 * t, t / ours, t / ours_connected);
      return;
    }
    fmt::print("  {:21} does not reach it\n", name);
  };
#ifdef RFSMOOTH_BENCH_OPEN3D
  const std::vector<double> counts = {1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, 50};
  peer("Open3D Taubin", counts,
       [&](double k) { return open3d_taubin(xyz.data(), n, faces.data(), m, int(k)); });
  peer("Open3D Laplacian", counts,
       [&](double k) { return open3d_laplacian(xyz.data(), n, faces.data(), m, int(k)); });
#endif
  if (cgal) {
    const double h = support::mean_edge(mesh);
    std::vector<double> times;
    for (const double k : {0.1, 0.3, 1.0, 3.0, 10.0}) times.push_back(k * h * h);
    peer("CGAL smooth_shape", times,
         [&](double t) { return cgal_smooth_shape(xyz.data(), n, faces.data(), m, t); });
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string part = argc > 1 ? argv[1] : "";
  if (part.empty() || part == "steps") steps();
  if (part.empty() || part == "desbrun") desbrun();
  if (part.empty() || part == "peers") {
    beside_peers(6, true);
    beside_peers(8, false);
  }
}
