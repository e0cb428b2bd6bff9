/// The spatial index and the EMST beside their peers, interleaved in one run.
///
///     emst_bench [n = 1000000] [rounds = 5] [largest n of the scaling table = 0: none]
///
/// Every measurement is a process of its own (this program with `--one`), so that peaks of memory are the
/// method's and nothing is warm; the rounds go over all methods in turn and the medians and their ratios are
/// printed. The cloud: random points of a torus, moved by half a spacing of isotropic noise, in random order.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/parallel.h"
#include "rfs_mesh/connect/emst/emst.h"
#include "tests/bench/peers/index_peers.h"
#include "tests/bench/support/median.h"
#ifdef RFSMOOTH_BENCH_CGAL
#include "tests/bench/peers/emst_cgal.h"
#endif

using rfsmooth::Context;
using rfsmooth::Positions;
using rfsmooth::rfs_mesh::make_working_cloud;
using rfsmooth::rfs_mesh::SpatialIndex;
using rfsmooth::rfs_mesh::WorkingCloud;
namespace peers = rfsmooth::bench::peers;

namespace {

std::vector<double> noisy_torus(std::size_t n) {
  constexpr double kPi = 3.14159265358979323846, kBig = 2, kSmall = 0.7;
  std::mt19937_64 engine(42);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double spacing = std::sqrt(4 * kPi * kPi * kBig * kSmall / double(n));
  std::normal_distribution<double> noise(0, 0.5 * spacing);
  std::vector<double> xyz;
  xyz.reserve(3 * n);
  while (xyz.size() < 3 * n) {
    const double u = 2 * kPi * uniform(engine), v = 2 * kPi * uniform(engine);
    const double ring = kBig + kSmall * std::cos(v);
    if (uniform(engine) * (kBig + kSmall) > ring) continue;  // uniform on the surface
    for (const double c : {ring * std::cos(u), ring * std::sin(u), kSmall * std::sin(v)})
      xyz.push_back(c + noise(engine));
  }
  return xyz;
}

class Stopwatch {
 public:
  /// Prints what the last stage took: `name seconds`.
  void lap(const char* name) {
    const auto now = std::chrono::steady_clock::now();
    std::printf("%s %.6f\n", name, std::chrono::duration<double>(now - last_).count());
    last_ = std::chrono::steady_clock::now();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// One method in this process.
void run_one(const std::string& method, std::size_t n, const Context& context) {
  const std::vector<double> xyz = noisy_torus(n);
  if (method == "nothing") return;
  if (method == "emst_own") {
    Stopwatch watch;
    const WorkingCloud cloud = make_working_cloud(xyz.data(), n, context).value();
    watch.lap("order");
    const SpatialIndex index(cloud.points, context);
    watch.lap("index");
    const auto edges = emst(index, index.nearest(6, context), context);
    watch.lap("tree");
    double total = 0;
    for (const auto& e : edges) total += (cloud.points[e[0]] - cloud.points[e[1]]).norm();
    std::printf("length %.15g\n", total);
    return;
  }
#ifdef RFSMOOTH_BENCH_CGAL
  if (method == "emst_cgal" || method == "emst_cgal_parallel") {
    Stopwatch watch;
    const double total = peers::emst_length_cgal(xyz.data(), n, method == "emst_cgal_parallel");
    watch.lap("tree");
    std::printf("length %.15g\n", total);
    return;
  }
#endif
  // The indices all get the points in Morton order, as the library's stages do.
  const WorkingCloud cloud = make_working_cloud(xyz.data(), n, context).value();
  if (method == "index_own") {
    Stopwatch watch;
    const SpatialIndex index(cloud.points, context);
    watch.lap("build");
    for (const int k : {8, 32}) {
      index.nearest(k, context);
      watch.lap(k == 8 ? "knn8" : "knn32");
    }
    return;
  }
  Stopwatch watch;
  const auto index = method == "index_flann" ? peers::flann_index(cloud.points[0].data(), n)
                                             : peers::nanoflann_index(cloud.points[0].data(), n);
  watch.lap("build");
  for (const int k : {9, 33}) {  // the point itself is among them
    std::vector<std::uint32_t> rows(n * std::size_t(k));
    rfsmooth::for_blocks(context, n, 1024,
                         [&](std::size_t b, std::size_t e) { index->nearest(b, e, k, rows.data()); });
    watch.lap(k == 9 ? "knn8" : "knn32");
  }
}

/// What a run of one method printed, and "peak": its resident memory in bytes.
std::map<std::string, double> spawn(const std::string& method, std::size_t n, int threads) {
  int ends[2];
  if (pipe(ends) != 0) std::exit(1);
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    close(ends[1]);
    execl("/proc/self/exe", "emst_bench", "--one", method.c_str(), std::to_string(n).c_str(),
          std::to_string(threads).c_str(), nullptr);
    _exit(1);
  }
  close(ends[1]);
  std::map<std::string, double> figures;
  std::FILE* out = fdopen(ends[0], "r");
  char name[64];
  double value;
  while (std::fscanf(out, "%63s %lf", name, &value) == 2) figures[name] = value;
  std::fclose(out);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (status != 0) {
    std::fprintf(stderr, "%s failed\n", method.c_str());
    std::exit(1);
  }
  figures["peak"] = double(usage.ru_maxrss) * 1024;
  figures["cpu"] = double(usage.ru_utime.tv_sec) + 1e-6 * double(usage.ru_utime.tv_usec);
  return figures;
}

/// Medians of all figures over the rounds; the methods take turns.
using Figures = std::map<std::string, std::map<std::string, double>>;
Figures measure(const std::vector<std::string>& methods, std::size_t n, int threads, int rounds) {
  std::map<std::string, std::map<std::string, std::vector<double>>> all;
  for (int round = 0; round < rounds; ++round)
    for (const std::string& method : methods)
      for (const auto& [name, value] : spawn(method, n, threads)) all[method][name].push_back(value);
  Figures medians;
  for (const auto& [method, figures] : all)
    for (const auto& [name, values] : figures) medians[method][name] = rfsmooth::bench::median(values);
  return medians;
}

void compare_indices(std::size_t n, int threads, int rounds) {
  const std::vector<std::string> methods = {"index_own", "index_flann", "index_nanoflann"};
  Figures figures = measure(methods, n, threads, rounds);
  std::printf("\nSpatial index, %zu points, %d thread(s): seconds, median of %d\n", n, threads, rounds);
  std::printf("  %-18s %8s %8s %8s\n", "", "build", "k = 8", "k = 32");
  for (const std::string& method : methods) {
    auto& f = figures[method];
    std::printf("  %-18s %8.3f %8.3f %8.3f\n", method.c_str(), f["build"], f["knn8"], f["knn32"]);
  }
}

void compare_trees(std::size_t n, int threads, int rounds) {
  std::vector<std::string> methods = {"emst_own"};
#ifdef RFSMOOTH_BENCH_CGAL
  methods.push_back("emst_cgal");
  if (threads > 1) methods.push_back("emst_cgal_parallel");
#endif
  const double base = spawn("nothing", n, threads)["peak"];
  Figures figures = measure(methods, n, threads, rounds);
  std::printf("\nEMST from points in random order, %zu points, %d thread(s): median of %d\n", n, threads,
              rounds);
  for (const std::string& method : methods) {
    auto& f = figures[method];
    const double seconds = f["order"] + f["index"] + f["tree"];
    std::printf("  %-18s %8.3f s  %5.0f bytes/point above the input  total length %.12g", method.c_str(),
                seconds, (f["peak"] - base) / double(n), f["length"]);
    if (method == "emst_own")
      std::printf("  (order %.3f, index %.3f, tree %.3f)", f["order"], f["index"], f["tree"]);
    else
      std::printf("  own/this = %.3f", (figures["emst_own"]["order"] + figures["emst_own"]["index"] +
                                        figures["emst_own"]["tree"]) /
                                           seconds);
    std::printf("\n");
  }
}

void scaling(std::size_t largest, int threads) {
  std::printf("\nEMST, growth with n, %d thread(s)\n  %10s %10s %22s\n", threads, "n", "seconds",
              "ns / (n log2 n)");
  for (std::size_t n = 100000; n <= largest; n *= 10) {
    auto f = measure({"emst_own"}, n, threads, 3)["emst_own"];
    const double seconds = f["order"] + f["index"] + f["tree"];
    std::printf("  %10zu %10.3f %22.2f\n", n, seconds, seconds * 1e9 / (double(n) * std::log2(double(n))));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 5 && std::strcmp(argv[1], "--one") == 0) {
    Context context;
    context.threads = std::atoi(argv[4]);
    rfsmooth::in_arena(context, [&] { run_one(argv[2], std::strtoull(argv[3], nullptr, 10), context); });
    return 0;
  }
  const std::size_t n = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000000;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 5;
  const std::size_t largest = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 0;
  for (const int threads : {1, 4}) {
    if (threads > int(std::thread::hardware_concurrency())) {
      std::printf("\n%d threads: not measured, this machine has fewer cores\n", threads);
      continue;
    }
    compare_indices(n, threads, rounds);
    compare_trees(n, threads, rounds);
    if (largest > 0) scaling(largest, threads);
  }
}
