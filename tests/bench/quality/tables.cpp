#include "tests/bench/quality/tables.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>

namespace rfsmooth::bench {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kUnit = 1e4;  // squared lengths are printed x 1e4, as in the papers' tables

std::string short_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, x < 0.1 ? "%.4f" : x < 10 ? "%.3f" : "%.1f", x);
  return text;
}

/// As a column shows it: a file's name without its folder.
std::string label(const std::string& shape) {
  return std::filesystem::path(shape).stem().string().substr(0, 16);
}

void print_row(const std::string& name, const std::map<std::string, Row>& rows,
               const std::vector<std::string>& shapes) {
  const auto over = [&](auto&& get) {
    double sum = 0;
    for (const auto& shape : shapes) sum += get(rows.at(shape));
    return sum / double(shapes.size());
  };
  const auto worst = [&](Measure m) {
    return *std::max_element(shapes.begin(), shapes.end(), [&](const auto& s, const auto& t) {
      return value(rows.at(s), m) < value(rows.at(t), m);
    });
  };
  for (const auto& shape : shapes)
    if (rows.count(shape) == 0) {
      std::printf("  %-34s  %zu of %zu shapes measured\n", name.c_str(), rows.size(), shapes.size());
      return;
    }
  const std::string cd = worst(Measure::chamfer), p2s = worst(Measure::p2s);
  std::printf("  %-34s %8s %8s %-16s %8s %8s %-16s %6.1f %6.3f %7.2f\n", name.c_str(),
              short_number(kUnit * mean(rows, shapes, Measure::chamfer)).c_str(),
              short_number(kUnit * value(rows.at(cd), Measure::chamfer)).c_str(), label(cd).c_str(),
              short_number(kUnit * mean(rows, shapes, Measure::p2s)).c_str(),
              short_number(kUnit * value(rows.at(p2s), Measure::p2s)).c_str(), label(p2s).c_str(),
              over([](const Row& r) { return r.measures.normal; }),
              over([](const Row& r) { return r.measures.evenness; }),
              over([](const Row& r) { return r.seconds; }));
}

std::vector<std::string> families() {
  std::vector<std::string> names;
  for (const auto& setting : peer_settings())
    if (std::find(names.begin(), names.end(), setting.family) == names.end()) names.push_back(setting.family);
  return names;
}

}  // namespace

double value(const Row& row, Measure measure) {
  switch (measure) {
    case Measure::chamfer:
      return row.measures.chamfer;
    case Measure::p2s:
      return row.measures.p2s;
    case Measure::edge_p2s:
      return row.measures.edge_p2s;
  }
  return 0;
}

double mean(const std::map<std::string, Row>& rows, const std::vector<std::string>& shapes, Measure measure) {
  double sum = 0;
  for (const auto& shape : shapes) {
    const auto row = rows.find(shape);
    if (row == rows.end()) return kNone;
    sum += value(row->second, measure);
  }
  return sum / double(shapes.size());
}

Best best_peer(const Cell& cell, const std::vector<std::string>& shapes, Measure measure,
               const std::string& family) {
  Best best{"", kNone};
  for (const auto& setting : peer_settings()) {
    const auto rows = cell.find(setting.name);
    if (rows == cell.end() || (!family.empty() && setting.family != family)) continue;
    const double m = mean(rows->second, shapes, measure);
    if (m < best.value) best = {setting.name, m};
  }
  return best;
}

Ratio compare(const Cell& cell, const std::string& ours, const std::vector<std::string>& shapes,
              Measure measure) {
  Ratio ratio;
  const auto mine = cell.find(ours);
  const Best best = best_peer(cell, shapes, measure);
  if (mine == cell.end() || best.setting.empty()) {
    ratio.of_means = kNone;
    return ratio;
  }
  ratio.of_means = mean(mine->second, shapes, measure) / best.value;
  for (const auto& shape : shapes) {
    const auto row = mine->second.find(shape);
    if (row == mine->second.end()) continue;
    const Best here = best_peer(cell, {shape}, measure);
    const double x = value(row->second, measure);
    if (x / here.value > ratio.worst) {
      ratio.worst = x / here.value;
      ratio.worst_shape = label(shape);
      ratio.worst_peer = here.setting;
    }
    const double fixed = x / value(cell.at(best.setting).at(shape), measure);
    if (fixed > ratio.worst_fixed) {
      ratio.worst_fixed = fixed;
      ratio.worst_fixed_shape = label(shape);
    }
  }
  return ratio;
}

void print_tables(const Plan& plan, const Results& results, const std::vector<std::string>& ours, bool all) {
  for (const auto& noise : plan.noises) {
    std::printf(
        "\n%s, %zu shapes. CD and p2s x 1e4 on the unit sphere; per family the best setting chosen with the "
        "truth\n",
        noise.name().c_str(), plan.shapes.size());
    for (const std::size_t size : plan.sizes) {
      const auto found = results.find({noise.name(), size});
      if (found == results.end()) continue;
      const Cell& cell = found->second;
      std::printf("\n  %-34s %8s %8s %-16s %8s %8s %-16s %6s %6s %7s\n",
                  (std::to_string(size) + " points").c_str(), "CD mean", "worst", "on", "p2s mean", "worst",
                  "on", "normal", "even", "seconds");
      std::vector<std::string> names = {"noisy input"};
      names.insert(names.end(), ours.begin(), ours.end());
      if (all) {
        for (const auto& setting : peer_settings()) names.push_back(setting.name);
      } else {
        for (const auto& family : families()) {
          const auto cd = best_peer(cell, plan.shapes, Measure::chamfer, family),
                     p2s = best_peer(cell, plan.shapes, Measure::p2s, family);
          if (!cd.setting.empty()) names.push_back(cd.setting);
          if (p2s.setting != cd.setting) names.push_back(p2s.setting);
        }
      }
      for (const auto& name : names)
        if (cell.count(name) > 0) print_row(name, cell.at(name), plan.shapes);
    }
  }
}

void write_csv(const std::filesystem::path& file, const Results& results) {
  std::ofstream out(file);
  out << "noise,points,shape,tool,chamfer,p2s,p2s_max,normal_degrees,evenness,edge_p2s,measured,edge_points,"
         "seconds,threads\n";
  for (const auto& [key, cell] : results)
    for (const auto& [tool, rows] : cell)
      for (const auto& [shape, row] : rows) {
        const auto& m = row.measures;
        out << key.first << ',' << key.second << ',' << shape << ',' << tool << ',' << m.chamfer << ','
            << m.p2s << ',' << m.p2s_max << ',' << m.normal << ',' << m.evenness << ',' << m.edge_p2s << ','
            << m.points << ',' << m.edge_points << ',' << row.seconds << ',' << row.threads << '\n';
      }
}

}  // namespace rfsmooth::bench
