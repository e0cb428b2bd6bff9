/// The whole of `denoise` beside PCL's moving least squares and CGAL's jets: nine clouds and the worst ratio;
/// then stages, points per second, peak memory, the same bytes for 1, 2 and 4 threads, and how time per point
/// grows (../README.md).
///
/// Every run is a process of its own, forked from one that has never started a thread, so that peaks of
/// memory are the tool's; the rounds go over the tools in turn, so that both meet the same load of the
/// machine.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>

#include "clouds/shapes/sampling.h"
#include "pipeline/io/io.h"
#include "tests/bench/peers/peers.h"
#include "tests/bench/quality/data/dataset.h"
#include "tests/bench/quality/ours.h"
#include "tests/bench/support/apart.h"
#include "tests/bench/support/main.h"
#include "tests/bench/support/median.h"

namespace {

using namespace rfsmooth::bench;
using rfsmooth::Positions;
namespace clouds = rfsmooth::clouds;
namespace pipeline = rfsmooth::pipeline;

constexpr double kPi = 3.14159265358979323846;

/// n points of a bumpy sphere, evenly spread (Fibonacci lattice), with isotropic noise of `sigma` mean
/// distances to the nearest neighbour, in random order. One thread; the same for the same arguments.
Positions noisy_cloud(std::size_t n, double sigma) {
  // The mean nearest distance of this lattice, bumps included, is 0.963 sqrt(4 pi / n) (counted for n = 1e5).
  const double spacing = 0.963 * std::sqrt(4 * kPi / double(n));
  std::mt19937_64 engine(7);
  std::normal_distribution<double> noise(0, sigma * spacing);
  Positions points(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * double(i) + 1) / double(n), turn = kPi * (3 - std::sqrt(5.0)) * double(i);
    const double r = std::sqrt(1 - z * z);
    const Eigen::Vector3d p(r * std::cos(turn), r * std::sin(turn), z);
    const double bump = 1 + 0.05 * std::sin(5 * p[0]) * std::sin(5 * p[1]) * std::sin(5 * p[2]);
    const double x = noise(engine), y = noise(engine), w = noise(engine);
    points[i] = bump * p + Eigen::Vector3d(x, y, w);
  }
  std::shuffle(points.begin(), points.end(), engine);
  return points;
}

/// What a run tells its parent.
struct Run {
  double seconds = 0, cpu = 0;
  double bytes = 0;  ///< peak above the process before the run, plus the input's own 24 bytes a point
  std::uint64_t hash = 0;
  std::map<std::string, double> stages;
};

/// Runs `tool` on the points in a process of its own.
Run run_on(const Positions& points, const std::function<Positions(Run&)>& tool) {
  const Apart apart = run_apart([&](const Measure& measure) {
    Run run;
    Positions out;
    measure([&] { out = tool(run); });
    std::string text = std::to_string(hash_points(out)) + "\n";
    for (const auto& [name, seconds] : run.stages) text += std::to_string(seconds) + " " + name + "\n";
    return text;
  });
  Run run;
  run.seconds = apart.cost.seconds;
  run.cpu = apart.cost.cpu;
  run.bytes = apart.cost.bytes + 24 * double(points.size());
  std::istringstream in(apart.said);
  in >> run.hash;
  for (double seconds = 0; in >> seconds;) {
    std::string name;
    std::getline(in >> std::ws, name);
    run.stages[name] = seconds;
  }
  return run;
}

Run ours(const Positions& points, const Variant& variant, int threads) {
  return run_on(points, [&](Run& run) {
    auto result = run_ours(points, variant, threads);
    for (std::size_t i = 0; i < result.report.seconds.size(); ++i)  // numbered: the map keeps their order
      run.stages[std::string(1, char('a' + i % 26)) + " " + result.report.seconds[i].name] =
          result.report.seconds[i].seconds;
    return std::move(result.points);
  });
}

Run mls(const Positions& points, int threads) {
  return run_on(points, [&](Run&) { return peers::pcl_mls(points, 48, threads).points; });
}

Run jet(const Positions& points, int threads) {
  return run_on(points, [&](Run&) { return peers::cgal_jet(points, 24, 1, threads).points; });
}

double median_of(const std::vector<Run>& runs, double Run::*field) {
  std::vector<double> values;
  values.reserve(runs.size());
  for (const auto& run : runs) values.push_back(run.*field);
  return median(values);
}

void print_tool(const char* name, const std::vector<Run>& runs, std::size_t n) {
  const double seconds = median_of(runs, &Run::seconds);
  std::printf("    %-12s %8.2f s wall %8.2f s CPU %10.0f points/s %6.0f bytes a point at the peak\n", name,
              seconds, median_of(runs, &Run::cpu), double(n) / seconds,
              median_of(runs, &Run::bytes) / double(n));
}

void beside_mls(const Positions& points, const Variant& variant, const std::vector<int>& threads,
                int rounds) {
  std::map<int, std::vector<Run>> mine, theirs;
  for (int round = 0; round < rounds; ++round)
    for (const int t : threads) {
      mine[t].push_back(ours(points, variant, t));
      theirs[t].push_back(mls(points, t));
      std::fprintf(stderr, "round %d, %d threads: done\n", round + 1, t);
    }
  bool same = true;
  for (const int t : threads) {
    std::printf("\n  %d thread%s, median of %d interleaved runs\n", t, t == 1 ? "" : "s", rounds);
    print_tool("rfsmooth", mine[t], points.size());
    print_tool("PCL MLS k 48", theirs[t], points.size());
    std::vector<double> wall, cpu;
    for (int i = 0; i < rounds; ++i) {
      const auto at = std::size_t(i);
      wall.push_back(mine[t][at].seconds / theirs[t][at].seconds);
      cpu.push_back(mine[t][at].cpu / theirs[t][at].cpu);
    }
    std::printf("    ratio, median of the rounds' own: wall %.2f, CPU %.2f\n    stages:", median(wall),
                median(cpu));
    for (const auto& [name, seconds] : mine[t].front().stages) {
      std::vector<double> values;
      for (const auto& run : mine[t]) values.push_back(run.stages.at(name));
      std::printf(" %s %.2f s;", name.substr(2).c_str(), median(values));
    }
    std::printf("\n");
    for (const auto& run : mine[t]) same = same && run.hash == mine[threads.front()].front().hash;
  }
  std::printf("\n  same bytes in every run of rfsmooth on");
  for (const int t : threads) std::printf(" %d", t);
  std::printf(" threads: %s (hash %016llx)\n", same ? "yes" : "NO",
              static_cast<unsigned long long>(mine[threads.front()].front().hash));
}

/// A cloud without noise of ours, and the mean distance to the nearest neighbour in it.
struct Subject {
  std::string name;
  Positions points;
  double spacing = 0;
};

/// Made in a process of its own: this one must not start threads.
Subject subject(const std::string& name, const std::function<Positions()>& make) {
  const Apart made = run_apart([&](const Measure&) {
    const Positions points = make();
    const double spacing = clouds::mean_spacing(points);
    std::string bytes(sizeof spacing + points.size() * sizeof(Eigen::Vector3d), 0);
    std::memcpy(bytes.data(), &spacing, sizeof spacing);
    std::memcpy(bytes.data() + sizeof spacing, points.data(), bytes.size() - sizeof spacing);
    return bytes;
  });
  Subject all{name, Positions((made.said.size() - sizeof(double)) / sizeof(Eigen::Vector3d))};
  std::memcpy(&all.spacing, made.said.data(), sizeof all.spacing);
  std::memcpy(static_cast<void*>(all.points.data()), made.said.data() + sizeof all.spacing,
              made.said.size() - sizeof all.spacing);
  return all;
}

/// The finite points of a file.
Positions read_points(const std::string& file) {
  const auto cloud = value_or_throw(pipeline::io::read_cloud(file, {}, {}));
  const std::vector<double> xyz = pipeline::io::positions(cloud);
  Positions points;
  for (std::size_t i = 0; i < xyz.size(); i += 3)
    if (const Eigen::Vector3d p = Eigen::Map<const Eigen::Vector3d>(xyz.data() + i); p.allFinite())
      points.push_back(p);
  return points;
}

std::vector<Subject> subjects(std::size_t n, const std::string& scan) {
  std::vector<Subject> all;
  all.push_back(subject("bumpy sphere", [&] { return noisy_cloud(n, 0); }));
  all.push_back(subject("CAD part", [&] {
    return clouds::sample(load_shape("anchor_dense"), n, 7, clouds::Sampling::uniform);
  }));
  if (scan.empty())
    std::printf("  a real scan: not measured, --scan names none\n");
  else
    all.push_back(subject(scan, [&] { return read_points(scan); }));
  return all;
}

/// Every subject at every noise, the three tools in turn; ratios are medians of the rounds' own.
void nine(std::size_t n, const std::string& scan, const std::vector<double>& noises, const Variant& variant,
          int threads, int rounds) {
  std::printf(
      "\n  %d thread(s), median of %d interleaved rounds; ratios of CPU (wall) time to MLS k 48 and jet k "
      "24\n"
      "    %-34s %9s %6s %9s %9s %9s %14s %14s %9s\n",
      threads, rounds, "cloud", "points", "noise", "ours CPU", "MLS CPU", "jet CPU", "ours/MLS", "ours/jet",
      "bytes/pt");
  double worst = 0;
  for (const Subject& subject : subjects(n, scan)) {
    for (const double noise : noises) {
      Positions points = subject.points;
      clouds::add_noise(points, noise * subject.spacing, 7);
      std::vector<Run> mine, least_squares, jets;
      std::vector<double> cpu[2], wall[2];
      for (int round = 0; round < rounds; ++round) {
        mine.push_back(ours(points, variant, threads));
        least_squares.push_back(mls(points, threads));
        jets.push_back(jet(points, threads));
        const Run* const peers[2] = {&least_squares.back(), &jets.back()};
        for (int k = 0; k < 2; ++k) {
          cpu[k].push_back(mine.back().cpu / peers[k]->cpu);
          wall[k].push_back(mine.back().seconds / peers[k]->seconds);
        }
      }
      worst = std::max(worst, median(cpu[0]));
      std::printf("    %-34s %9zu %6g %9.2f %9.2f %9.2f %6.2f (%5.2f) %6.2f (%5.2f) %9.0f\n",
                  std::filesystem::path(subject.name).filename().c_str(), points.size(), noise,
                  median_of(mine, &Run::cpu), median_of(least_squares, &Run::cpu), median_of(jets, &Run::cpu),
                  median(cpu[0]), median(wall[0]), median(cpu[1]), median(wall[1]),
                  median_of(mine, &Run::bytes) / double(points.size()));
      std::fflush(stdout);
    }
  }
  std::printf("    worst ratio of CPU time to MLS: %.2f\n", worst);
}

void scaling(const std::vector<std::size_t>& sizes, double sigma, const Variant& variant, int threads) {
  std::printf("\n  time per point, %d threads, one run each\n", threads);
  double least = 0, most = 0;
  for (const std::size_t n : sizes) {
    const Positions points = noisy_cloud(n, sigma);
    const Run run = ours(points, variant, threads);
    const double each = 1e6 * run.seconds / double(n);
    least = least == 0 ? each : std::min(least, each);
    most = std::max(most, each);
    std::printf(
        "    %9zu points %9.2f s wall %9.2f s CPU %7.3f us wall %7.3f us CPU and %5.0f bytes a point\n", n,
        run.seconds, run.cpu, each, 1e6 * run.cpu / double(n), run.bytes / double(n));
    std::fflush(stdout);
  }
  std::printf("    slowest over fastest per point: %.2f\n", most / least);
}

int run(int argc, char** argv) {
  std::size_t n = 1000000;
  int rounds = 5;
  double sigma = 1;
  std::vector<int> threads = {1, 2, 4};
  std::vector<std::size_t> sizes = {100000, 1000000, 10000000};
  Variant variant{"rfsmooth", {}};
  std::vector<double> noises = {0.3, 1, 2};
  std::string scan;
  bool no_scaling = false, only_nine = false;
  CLI::App app{"denoise beside PCL's moving least squares and CGAL's jets: time, memory, same bytes"};
  app.add_option("--points", n)->capture_default_str();
  app.add_option("--rounds", rounds, "interleaved runs of each tool; medians are printed")
      ->capture_default_str();
  app.add_option("--noise", sigma, "x mean distance to the nearest neighbour")->capture_default_str();
  app.add_option("--threads", threads, "numbers of threads to measure")->capture_default_str();
  app.add_option("--options", variant.options, "options of denoise: flow=hc no-swap ...");
  app.add_option("--scaling-sizes", sizes)->capture_default_str();
  app.add_option("--scan", scan, "a real scan, the third of the clouds");
  app.add_option("--noises", noises, "added to the three clouds, x spacing")->capture_default_str();
  app.add_flag("--no-scaling", no_scaling);
  app.add_flag("--only-nine", only_nine, "nothing behind the table of the nine clouds");
  CLI11_PARSE(app, argc, argv);
  make_options(variant.options);  // says what is wrong before anything long starts

  const unsigned cores = std::thread::hardware_concurrency();
  std::printf("%zu points of a bumpy sphere, isotropic noise of %g spacings, %u cores\n", n, sigma, cores);
  std::vector<int> possible;
  for (const int t : threads)
    if (t <= int(cores))
      possible.push_back(t);
    else
      std::printf("  %d threads: not measured, there are %u cores\n", t, cores);
  if (possible.empty()) return 0;
  nine(n, scan, noises, variant, possible.back(), rounds);
  if (only_nine) return 0;
  beside_mls(noisy_cloud(n, sigma), variant, possible, rounds);
  if (!no_scaling) scaling(sizes, sigma, variant, possible.back());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return tell_failures("speed", run, argc, argv);
}
