/// Whole sensors: rfsmooth beside PCL's MLS and CGAL's jets on what lasers and depth cameras see of a room
/// whose surface is known (../README.md).
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "tests/bench/sensors/sensor_runs.h"
#include "tests/bench/support/main.h"

namespace {

using namespace rfsmooth::bench;
namespace clouds = rfsmooth::clouds;

/// A sensor at one level.
struct Cell {
  std::string sensor;
  double times = 1;
  SensorRow row;
};

/// What a peer left; infinite if it failed.
Distances of_peer(const SensorRow& row, const char* setting) {
  constexpr double kFailed = std::numeric_limits<double>::infinity();
  const auto found = row.peers.find(setting);
  return found == row.peers.end() ? Distances{kFailed, kFailed, kFailed} : found->second;
}

void print_head() {
  std::printf(
      "Distances to the surface in mm: raw, ours, PCL's MLS (k = 48), CGAL's jet (k = 24), and ours over the "
      "others'.\nNear: of the points within %.0f m. Noise, left: as reported; /true: left over the rms.\n\n"
      "  %5s | %6s %6s %6s %6s  %4s %4s %4s | %6s %6s %6s %6s  %4s %4s %4s | %6s %6s %6s %6s  %4s %4s %4s | "
      "%6s %6s %5s "
      "%5s\n",
      kNear, "times", "rms", "ours", "MLS48", "jet24", "/raw", "/MLS", "/jet", "median", "ours", "MLS48",
      "jet24", "/raw", "/MLS", "/jet", "near", "ours", "MLS48", "jet24", "/raw", "/MLS", "/jet", "noise",
      "left", "/true", "sec");
}

/// One measure of the four clouds, and the ratios.
void print_measure(const SensorRow& row, double Distances::*measure) {
  const double raw = row.raw.*measure, ours = row.ours.*measure;
  const double mls = of_peer(row, kFixedMls).*measure, jet = of_peer(row, kFixedJet).*measure;
  std::printf(" %6.2f %6.2f %6.2f %6.2f  %4.2f %4.2f %4.2f |", 1e3 * raw, 1e3 * ours, 1e3 * mls, 1e3 * jet,
              ours / raw, ours / mls, ours / jet);
}

void print_row(const Cell& cell) {
  const SensorRow& row = cell.row;
  std::printf("  %5.3g |", cell.times);
  print_measure(row, &Distances::rms);
  print_measure(row, &Distances::median);
  if (row.near_share > 0 && row.near_share < 1)
    print_measure(row, &Distances::near);
  else
    std::printf(" %43s |", row.near_share > 0 ? "all are near" : "none are near");
  std::printf(" %6.2f %6.2f %5.2f %5.1f\n", 1e3 * row.noise, 1e3 * row.left, row.left / row.ours.rms,
              row.seconds);
  std::fflush(stdout);
}

/// The sensors and levels that something is true of, as a list.
std::string where(const std::vector<Cell>& cells, const std::function<bool(const SensorRow&)>& holds) {
  std::ostringstream list;
  std::size_t count = 0;
  for (const Cell& cell : cells)
    if (holds(cell.row)) list << (count++ == 0 ? ": " : ", ") << cell.sensor << " x " << cell.times;
  return std::to_string(count) + list.str();
}

void print_behind(const std::vector<Cell>& cells) {
  const auto more_than = [&](double share, double Distances::*measure,
                             const std::function<Distances(const SensorRow&)>& of) {
    return where(cells, [&](const SensorRow& row) { return row.ours.*measure > share * (of(row).*measure); });
  };
  const auto raw = [](const SensorRow& row) { return row.raw; };
  const auto mls = [](const SensorRow& row) { return of_peer(row, kFixedMls); };
  const auto jet = [](const SensorRow& row) { return of_peer(row, kFixedJet); };
  std::printf("\nOf %zu, ours leaves more than\n", cells.size());
  for (const auto& [measure, word] :
       {std::pair(&Distances::rms, "rms"), std::pair(&Distances::median, "median"),
        std::pair(&Distances::near, "near")}) {
    std::printf("  0.6 of raw, %s: %s\n", word, more_than(0.6, measure, raw).c_str());
    std::printf("  MLS, %s: %s\n", word, more_than(1, measure, mls).c_str());
    std::printf("  jet, %s: %s\n", word, more_than(1, measure, jet).c_str());
  }
}

void write_rows(const std::string& file, const std::vector<Cell>& cells) {
  std::ofstream out(file);
  out << "sensor,times,points,tool,rms,median,near,noise,left,seconds\n";
  for (const auto& [sensor, times, row] : cells) {
    std::map<std::string, Distances> tools = row.peers;
    tools["raw"] = row.raw;
    tools["rfsmooth"] = row.ours;
    for (const auto& [tool, d] : tools)
      out << sensor << ',' << times << ',' << row.points << ',' << tool << ',' << d.rms << ',' << d.median
          << ',' << d.near << ',' << row.noise << ',' << row.left << ',' << row.seconds << '\n';
  }
}

std::vector<Cell> go_through(const SensorPlan& plan) {
  std::vector<Cell> cells;
  print_head();
  for (const auto& name : plan.sensors) {
    const clouds::Sensor* const known = clouds::find_sensor(name);
    if (known == nullptr) throw std::invalid_argument("no sensor is called \"" + name + "\"");
    std::printf("%s: %s\n", name.c_str(), std::string(known->says).c_str());
    for (const double times : plan.levels.empty() ? known->levels : plan.levels) {
      cells.push_back({name, times, measure_sensor(plan, clouds::scaled(*known, times))});
      print_row(cells.back());
    }
  }
  return cells;
}

int run(int argc, char** argv) {
  SensorPlan plan;
  plan.cache = default_cache();
  for (const auto& sensor : clouds::sensors()) plan.sensors.emplace_back(sensor.name);
  std::string csv;
  CLI::App app{"rfsmooth beside its peers on what whole sensors see of a room"};
  app.add_option("--sensors", plan.sensors, "only these");
  app.add_option("--times", plan.levels, "noise larger by these factors instead of each sensor's own");
  app.add_option("--seed", plan.seed, "of the noise")->capture_default_str();
  app.add_option("--options", plan.ours.options,
                 "options of denoise for every run of ours: flow=hc no-swap ...");
  app.add_option("--threads", plan.threads, "for every tool")->capture_default_str();
  app.add_option("--cache", plan.cache, "folder of peers' results")->capture_default_str();
  app.add_option("--csv", csv, "write every row to this file");
  CLI11_PARSE(app, argc, argv);
  const std::vector<Cell> cells = go_through(plan);
  print_behind(cells);
  if (!csv.empty()) write_rows(csv, cells);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return tell_failures("sensors", run, argc, argv);
}
