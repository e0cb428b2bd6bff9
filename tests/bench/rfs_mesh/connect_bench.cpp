// The connection stage (index, neighbours, local surfaces, noise, EMST, SDG, RFS-mesh): quality of the mesh
// on shapes whose surface is known, and time and memory beside CGAL's sequential Delaunay + Kruskal.
//
//   connect_bench                          everything: quality, then speed at 1,000,000 points, five rounds
//   connect_bench quality                  the tables of connect_quality.h alone
//   connect_bench speed [N] [ROUNDS]       time and memory alone
//
// The clouds of the speed table: random points of a sphere with isotropic noise of 0.3, 1 and 3 spacings
// (sqrt(area / n)), in Morton order as the pipeline hands them over. Every run is a process of its own, so
// that peaks of memory are the method's; ours and CGAL's take turns; medians over the rounds, and the median
// of each round's own ratio, which stands when the machine is busy with other things.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <rfsmooth/connect.h>

#include "base/morton.h"
#include "base/parallel.h"
#include "rfs_mesh/connect/edge_swap.h"
#include "tests/bench/rfs_mesh/connect_quality.h"
#include "tests/bench/support/median.h"
#include "tests/support/shapes.h"
#ifdef RFSMOOTH_BENCH_CGAL
#include "tests/bench/peers/emst_cgal.h"
#endif

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double resident(const char* key) {  // kB -> bytes
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind(key, 0) == 0) return 1024 * std::stod(line.substr(std::strlen(key) + 1));
  return 0;
}

/// Figures by name; stages are "CPU seconds" under "stage a index", "stage b neighbours", ... in their order.
using Figures = std::map<std::string, double>;

Figures run_ours(const Positions& points, int threads) {
  Figures figures;
  Context context;
  context.threads = threads;
  std::string stage;
  double since = 0;
  char letter = 'a';
  const auto next = [&](const std::string& name) {
    const double now = cpu_seconds();
    if (!stage.empty()) figures["stage " + std::string(1, letter++) + " " + stage] = now - since;
    stage = name;
    since = now;
  };
  context.progress = [&](std::string_view name, double) {
    next(std::string(name));
    return true;
  };
  const double wall = wall_seconds(), cpu = cpu_seconds();
  Connection connection = connect(points, {}, context).value();
  next("");
  figures["seconds"] = wall_seconds() - wall;
  figures["cpu"] = cpu_seconds() - cpu;
  figures["bytes"] = resident("VmHWM:");
  const double before_swaps = cpu_seconds();
  in_arena(context, [&] { swap_edges(connection.mesh, {}, context); });
  figures["swaps"] = cpu_seconds() - before_swaps;
  return figures;
}

Figures run_peer([[maybe_unused]] const Positions& points) {
  Figures figures;
#ifdef RFSMOOTH_BENCH_CGAL
  const auto xyz = bench::flat(points);
  const double wall = wall_seconds(), cpu = cpu_seconds();
  bench::peers::emst_length_cgal(xyz.data(), points.size(), false);
  figures["seconds"] = wall_seconds() - wall;
  figures["cpu"] = cpu_seconds() - cpu;
  figures["bytes"] = resident("VmHWM:");
#endif
  return figures;
}

/// Runs `body` in a process of its own, forked before this one ever starts a thread; "bytes" becomes the peak
/// above what was resident.
template <class Body>
Figures apart(Body&& body) {
  int ends[2];
  if (pipe(ends) != 0) std::exit(1);
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    std::ofstream("/proc/self/clear_refs") << 5;  // the peak starts at what is resident now
    const double before = resident("VmRSS:");
    Figures figures = body();
    figures["bytes"] -= before;
    std::FILE* out = fdopen(ends[1], "w");
    for (const auto& [name, value] : figures) std::fprintf(out, "%.9g %s\n", value, name.c_str());
    std::fclose(out);
    _exit(0);
  }
  close(ends[1]);
  Figures figures;
  std::FILE* in = fdopen(ends[0], "r");
  double value = 0;
  char name[128];
  while (std::fscanf(in, "%lf %127[^\n]", &value, name) == 2) figures[name] = value;
  std::fclose(in);
  int status = 0;
  waitpid(child, &status, 0);
  if (status != 0) {
    fmt::print(stderr, "connect_bench: a run failed\n");
    std::exit(1);
  }
  return figures;
}

Figures medians(const std::vector<Figures>& rounds) {
  Figures result;
  for (const auto& [name, first] : rounds.front()) {
    std::vector<double> values;
    for (const Figures& f : rounds) values.push_back(f.at(name));
    result[name] = bench::median(values);
  }
  return result;
}

/// In Morton order, without the library's own function: that would start threads.
Positions noisy_sphere(std::size_t n, double noise) {
  const double sigma = noise * std::sqrt(4 * M_PI / double(n));
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal;
  Positions points = test::random_points(test::unit_sphere(), n, 1);
  for (auto& p : points) {
    const double x = normal(engine), y = normal(engine), z = normal(engine);
    p += sigma * Eigen::Vector3d(x, y, z);
  }
  Eigen::Vector3d low = points[0], high = points[0];
  for (const auto& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  std::vector<std::pair<std::uint64_t, std::size_t>> order(n);
  for (std::size_t i = 0; i < n; ++i)
    order[i] = {morton_code(points[i], low, kMortonCells / (high - low).maxCoeff()), i};
  std::sort(order.begin(), order.end());
  Positions sorted;
  sorted.reserve(n);
  for (const auto& [code, i] : order) sorted.push_back(points[i]);
  return sorted;
}

void speed_at(std::size_t n, double noise, int threads, int rounds) {
  const Positions points = noisy_sphere(n, noise);
  std::vector<Figures> own, peer;
  std::vector<double> wall, cpu;
  for (int round = 0; round < rounds; ++round) {
    own.push_back(apart([&] { return run_ours(points, threads); }));
    peer.push_back(apart([&] { return run_peer(points); }));
    if (peer.back().count("seconds") == 0) continue;
    wall.push_back(own.back()["seconds"] / peer.back()["seconds"]);
    cpu.push_back(own.back()["cpu"] / peer.back()["cpu"]);
  }
  Figures f = medians(own), p = medians(peer);
  fmt::print(
      "\n{} points, noise {} spacings, {} thread(s): {:.2f} s, CPU {:.2f} s, peak {:.0f} bytes a point\n", n,
      noise, threads, f["seconds"], f["cpu"], f["bytes"] / double(n));
  for (const auto& [name, value] : f)
    if (name.rfind("stage ", 0) == 0) fmt::print("    {:16} CPU {:.2f} s\n", name.substr(8), value);
  fmt::print("    {:16} CPU {:.2f} s, not counted\n", "one swap pass", f["swaps"]);
  if (!wall.empty())
    fmt::print(
        "  CGAL sequential Delaunay + Kruskal: {:.2f} s, CPU {:.2f} s, peak {:.0f} bytes a point\n"
        "  ours / CGAL: wall {:.3f} (mark at four threads: 0.5, goal 0.25), CPU {:.3f}\n",
        p["seconds"], p["cpu"], p["bytes"] / double(n), bench::median(wall), bench::median(cpu));
  std::fflush(stdout);
}

void speed(std::size_t n, int rounds) {
  for (const int threads : {4, 1}) {
    if (threads > int(std::thread::hardware_concurrency())) {
      fmt::print("\n{} threads: not measured, this machine has fewer cores\n", threads);
      continue;
    }
    for (const double noise : {0.3, 1.0, 3.0}) speed_at(n, noise, threads, rounds);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "all";
  if (what == "all" || what == "speed")
    speed(argc > 2 ? std::size_t(std::atof(argv[2])) : 1000000, argc > 3 ? std::atoi(argv[3]) : 5);
  if (what == "all" || what == "quality") bench::connection_quality();
}
