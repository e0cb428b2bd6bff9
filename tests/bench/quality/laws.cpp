/// The laws of real noise: rfsmooth beside PCL's MLS and CGAL's jets on clouds whose truth is known
/// (../README.md).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>

#include <CLI/CLI.hpp>

#include "tests/bench/quality/law_runs.h"
#include "tests/bench/support/main.h"

namespace {

using namespace rfsmooth::bench;

/// A law and a size: shape -> row.
using LawCell = std::map<std::string, LawRow>;

double mean_over(const LawCell& cell, const std::function<double(const LawRow&)>& get) {
  double sum = 0;
  for (const auto& [shape, row] : cell) sum += get(row);
  return sum / double(cell.size());
}

/// A peer's mean squared distance over the shapes; infinite if it failed on one.
double peer_mean(const LawCell& cell, const std::string& setting) {
  return mean_over(cell, [&](const LawRow& row) {
    const auto found = row.peers.find(setting);
    return found == row.peers.end() ? std::numeric_limits<double>::infinity() : found->second;
  });
}

/// The setting that is best for the whole cell, chosen with the truth.
std::string best_setting(const LawCell& cell) {
  std::string best = kFixedMls;
  for (const auto& setting : peer_settings())
    if (peer_mean(cell, setting.name) < peer_mean(cell, best)) best = setting.name;
  return best;
}

/// The largest ratio of one shape, and its name.
struct Worst {
  double ratio = 0;
  std::string shape;
};

Worst worst_over(const LawCell& cell, const std::function<double(const LawRow&)>& get) {
  Worst worst;
  for (const auto& [shape, row] : cell) {
    const double ratio = get(row);
    if (ratio > worst.ratio) worst = {ratio, shape};
  }
  return worst;
}

/// The larger of the ratios to the two fixed peers.
double to_fixed(const LawRow& row) {
  double ratio = 0;
  for (const char* peer : {kFixedMls, kFixedJet}) {
    const auto found = row.peers.find(peer);
    if (found != row.peers.end()) ratio = std::max(ratio, row.ours / found->second);
  }
  return ratio;
}

/// Geometric mean over the shapes of the larger ratio to a fixed peer: no shape counts more than another.
double typical(const LawCell& cell) {
  return std::exp(mean_over(cell, [](const LawRow& row) { return std::log(to_fixed(row)); }));
}

double left_over_truth(const LawRow& row) {
  return row.left / std::sqrt(row.ours);
}

void print_head(std::size_t size) {
  std::printf(
      "\n%zu points. Root mean square distance to the surface in spacings; ratios of mean squares, ours over "
      "the "
      "peer's;\ntypical and worst: of the larger ratio to MLS and jet, shape by shape; again, exact: worst "
      "shape\n"
      "  %-32s %6s %6s %6s %6s %6s | %6s %6s %6s %7s %6s %-18s | %6s %-11s %6s %6s %6s %6s  %s\n",
      size, "law", "raw", "ours", "MLS48", "jet24", "best", "/MLS", "/jet", "/best", "typical", "worst", "on",
      "noise", "left/truth", "again", "exact", ">0.05", "sec", "best setting");
}

void print_cell(const std::string& law, const LawCell& cell) {
  const auto mean = [&](double LawRow::*figure) {
    return mean_over(cell, [&](const LawRow& r) { return r.*figure; });
  };
  const auto largest = [&](double LawRow::*figure) {
    return worst_over(cell, [&](const LawRow& r) { return r.*figure; }).ratio;
  };
  const std::string setting = best_setting(cell);
  const double ours = mean(&LawRow::ours), mls = peer_mean(cell, kFixedMls), jet = peer_mean(cell, kFixedJet);
  const double best = peer_mean(cell, setting);
  const Worst worst = worst_over(cell, to_fixed);
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const auto& [shape, row] : cell) {
    least = std::min(least, left_over_truth(row));
    most = std::max(most, left_over_truth(row));
  }
  std::printf("  %-32s %6.3f %6.3f %6.3f %6.3f %6.3f | %6.2f %6.2f %6.2f %7.2f %6.2f %-18s", law.c_str(),
              std::sqrt(mean(&LawRow::raw)), std::sqrt(ours), std::sqrt(mls), std::sqrt(jet), std::sqrt(best),
              ours / mls, ours / jet, ours / best, typical(cell), worst.ratio, worst.shape.c_str());
  std::printf(" | %6.3f %4.2f - %4.2f %6.3f %6.3f %6.3f %6.1f  %s\n", mean(&LawRow::noise), least, most,
              largest(&LawRow::again), largest(&LawRow::exact_moved), largest(&LawRow::exact_share),
              mean(&LawRow::seconds), setting.c_str());
  std::fflush(stdout);
}

void print_goals(const std::map<std::string, LawCell>& cells, bool second_run) {
  std::size_t fixed = 0, best = 0, left = 0, again = 0;
  for (const auto& [name, cell] : cells) {
    const double ours = mean_over(cell, [](const LawRow& r) { return r.ours; });
    fixed += ours <= 0.9 * std::min(peer_mean(cell, kFixedMls), peer_mean(cell, kFixedJet));
    best += ours <= peer_mean(cell, best_setting(cell));
    left += std::all_of(cell.begin(), cell.end(),
                        [](const auto& of) { return std::abs(left_over_truth(of.second) - 1) <= 1.0 / 3; });
    again += worst_over(cell, [](const LawRow& r) { return r.again; }).ratio < 0.1;
  }
  std::printf(
      "\nOf %zu cells: %zu at most 0.9 of both fixed peers, %zu at most 1.0 of the best setting, %zu with "
      "\"left\" within a third of the truth on every shape",
      cells.size(), fixed, best, left);
  if (second_run) std::printf(", %zu with a second run below a tenth of the first on every shape", again);
  std::printf("\n");
}

void write_rows(const std::string& file, const std::map<std::string, LawCell>& cells) {
  std::ofstream out(file);
  out << "law and "
         "points,shape,measured,raw,ours,noise,left,again,exact_moved,exact_share,seconds,peer,error\n";
  for (const auto& [name, cell] : cells)
    for (const auto& [shape, r] : cell)
      for (const auto& [peer, error] : r.peers)
        out << name << ',' << shape << ',' << r.points << ',' << r.raw << ',' << r.ours << ',' << r.noise
            << ',' << r.left << ',' << r.again << ',' << r.exact_moved << ',' << r.exact_share << ','
            << r.seconds << ',' << peer << ',' << error << '\n';
}

/// One size, law by law. \return law and size -> cell.
std::map<std::string, LawCell> go_through(const LawPlan& plan, std::size_t size, bool each) {
  std::map<std::string, LawCell> cells;
  print_head(size);
  for (const auto& law : plan.laws) {
    LawCell cell;
    for (const auto& shape : plan.shapes) {
      const LawCase one = make_law_case(plan, law, shape, size);
      cell[shape] = measure_law_case(plan, one);
      if (each) print_cell(one.name, {*cell.find(shape)});
    }
    print_cell(law, cell);
    cells[law + " " + std::to_string(size)] = std::move(cell);
  }
  return cells;
}

int run(int argc, char** argv) {
  LawPlan plan;
  plan.cache = default_cache();
  for (const auto& law : rfsmooth::clouds::laws()) plan.laws.emplace_back(law.name);
  bool quick = false, each = false, once = false;
  std::string csv;
  CLI::App app{"rfsmooth beside its peers under the noise of real scanners"};
  app.add_flag("--quick", quick, "six shapes, 10,000 points, the two peers at their fixed settings");
  app.add_option("--laws", plan.laws, "only these");
  app.add_option("--shapes", plan.shapes, "only these; the path of an OFF file is one, too");
  app.add_option("--points", plan.sizes, "numbers of points")->capture_default_str();
  app.add_option("--times", plan.times, "all noise larger by this factor")->capture_default_str();
  app.add_option("--tier", plan.most_tier,
                 "the best setting is chosen from peers up to this tier; -1: none but the two fixed ones")
      ->capture_default_str();
  app.add_flag("--once", once, "no second run on what the first left");
  app.add_flag("--each", each, "a row for every shape, too");
  app.add_option("--options", plan.ours.options,
                 "options of denoise for every run of ours: flow=hc no-swap ...");
  app.add_option("--threads", plan.threads, "for every tool")->capture_default_str();
  app.add_option("--cache", plan.cache, "folder of samples and peers' results")->capture_default_str();
  app.add_option("--csv", csv, "write every row to this file");
  CLI11_PARSE(app, argc, argv);
  if (quick && app.count("--shapes") == 0)
    plan.shapes = {"anchor_dense", "rotor", "armadillo", "hand", "cube", "torus"};
  if (quick && app.count("--points") == 0) plan.sizes = {10000};
  if (quick && app.count("--tier") == 0) plan.most_tier = -1;
  plan.again = !once;
  std::map<std::string, LawCell> cells;
  for (const std::size_t size : plan.sizes) cells.merge(go_through(plan, size, each));
  print_goals(cells, plan.again);
  if (!csv.empty()) write_rows(csv, cells);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return tell_failures("laws", run, argc, argv);
}
