/// The noise figure and the noise field beside the truth, on the development shapes (../README.md).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>

#include "base/parallel.h"
#include "rfs_mesh/noise/noise.h"
#include "tests/bench/quality/data/closest.h"
#include "tests/bench/quality/data/dataset.h"
#include "tests/bench/support/main.h"
#include "tests/bench/support/median.h"

namespace {

using namespace rfsmooth;
using namespace rfsmooth::bench;
using Eigen::Vector3d;

constexpr std::size_t kJudged = 1000;  // points of a cloud at which the field is compared

/// What is true of one sample at its judged points.
struct Places {
  std::vector<std::size_t> rows;
  std::vector<Vector3d> normals;
  std::vector<double> thickness;  ///< to the next sheet along the normal, either side
};

/// Distance from p along the line of direction d, either way, to the next triangle that is not p's own.
double next_sheet(const Mesh& mesh, const Vector3d& p, const Vector3d& d) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& f : mesh.faces) {
    const Vector3d a = mesh.positions[f[0]] - p;
    const Vector3d b = mesh.positions[f[1]] - p - a, c = mesh.positions[f[2]] - p - a;
    const Vector3d across = d.cross(c);
    const double volume = b.dot(across);
    if (std::abs(volume) < 1e-300) continue;
    const double u = -a.dot(across) / volume;
    if (u < 0 || u > 1) continue;
    const Vector3d q = (-a).cross(b);
    const double v = d.dot(q) / volume;
    if (v < 0 || u + v > 1) continue;
    const double t = std::abs(c.dot(q) / volume);
    if (t > 1e-4) nearest = std::min(nearest, t);  // 1e-4 of the radius: its own sheet
  }
  return nearest;
}

Places look_at(const Sample& sample, const Context& context) {
  const ClosestTree surface(sample.mesh);
  const std::size_t n = sample.clean.size(), count = std::min(n, kJudged);
  Places places;
  places.rows.resize(count);
  places.normals.resize(count);
  places.thickness.resize(count);
  for_each_index(
      context, count,
      [&](std::size_t s) {
        const std::size_t row = s * n / count;
        const auto& f = sample.mesh.faces[surface.nearest(sample.clean[row]).primitive];
        const Vector3d &a = sample.mesh.positions[f[0]], &b = sample.mesh.positions[f[1]],
                       &c = sample.mesh.positions[f[2]];
        places.rows[s] = row;
        places.normals[s] = (b - a).cross(c - a).normalized();
        places.thickness[s] = next_sheet(sample.mesh, sample.clean[row], places.normals[s]);
      },
      8);
  return places;
}

/// One cell: a cloud with its noise.
struct Row {
  double figure = 0;  ///< measured over true
  double field = 0;   ///< median over the judged points of |log(measured / true)|
  double spread = 0;  ///< measured field, 90 % over 10 %
  bool counts = true;
};

Row measure(const Case& one, const Places& places, const Context& context, double& seconds) {
  const rfs_mesh::SpatialIndex index(one.noisy, context);
  const auto start = std::chrono::steady_clock::now();
  const rfs_mesh::NoiseField noise =
      rfs_mesh::spread_noise(rfs_mesh::measure_noise(index, context), one.noisy, context);
  seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  Row row;
  std::vector<double> errors, locals, truths;
  double squares = 0;
  std::size_t thin = 0;
  for (std::size_t s = 0; s < places.rows.size(); ++s) {
    const std::size_t i = places.rows[s];
    double truth = one.noise.sigma;
    if (one.noise.kind == NoiseKind::ray)
      truth *= std::abs((one.noisy[i] - one.truth->clean[i]).normalized().dot(places.normals[s]));
    squares += truth * truth;
    locals.push_back(noise.local[i]);
    if (3 * truth > places.thickness[s])
      ++thin;
    else
      errors.push_back(std::abs(std::log(noise.local[i] / std::max(truth, 1e-3 * one.noise.sigma))));
  }
  row.figure = noise.sigma / std::sqrt(squares / double(places.rows.size()));
  row.field = median(errors);
  std::sort(locals.begin(), locals.end());
  row.spread = locals[locals.size() * 9 / 10] / std::max(1e-300, locals[locals.size() / 10]);
  row.counts = 2 * thin <= places.rows.size();
  return row;
}

void summarise(const char* what, std::vector<std::pair<double, std::string>> errors) {
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  std::printf("  %-28s median %.3f  worst %.3f on %s (%zu cells)\n", what, errors[errors.size() / 2].first,
              errors.back().first, errors.back().second.c_str(), errors.size());
}

int run(int argc, char** argv) {
  std::vector<std::string> shapes = shape_names();
  std::vector<std::size_t> sizes = {10000, 50000};
  std::vector<double> shares = {0.1, 0.2, 0.5, 1, 2, 4};
  std::vector<std::string> kinds = {"gaussian", "ray"};
  std::filesystem::path cache = default_cache();
  Context context;
  context.threads = 2;
  CLI::App app{"measured noise beside the truth"};
  app.add_option("--shapes", shapes, "only these");
  app.add_option("--sizes", sizes, "numbers of points")->capture_default_str();
  app.add_option("--noises", shares, "standard deviations in spacings")->capture_default_str();
  app.add_option("--kinds", kinds, "gaussian, ray")->capture_default_str();
  app.add_option("--threads", context.threads, "threads")->capture_default_str();
  app.add_option("--cache", cache, "folder of samples")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  using Errors = std::vector<std::pair<double, std::string>>;
  std::map<std::string, Errors> figures, fields;
  Errors beyond;
  double seconds = 0;
  for (const std::size_t size : sizes) {
    std::map<std::string, std::map<std::string, Row>> rows;
    std::vector<std::pair<std::string, double>> clean;
    for (const auto& shape : shapes) {
      const auto sample = load_sample(shape, size, cache);
      const Places places = look_at(*sample, context);
      for (const auto& kind : kinds)
        for (const double share : shares) {
          Noise noise;
          noise.kind = kind == "ray" ? NoiseKind::ray : NoiseKind::gaussian;
          noise.sigma = share * sample->spacing;
          char name[64];
          std::snprintf(name, sizeof name, "%s %g", kind.c_str(), share);
          const Row row = measure(make_case(sample, noise), places, context, seconds);
          rows[shape][name] = row;
          const std::string where = shape + " " + std::to_string(size) + " " + name;
          const double error = std::abs(row.figure - 1);
          if (row.counts) {
            figures[kind].emplace_back(error, where);
            fields[kind].emplace_back(row.field, where);
          } else {
            beyond.emplace_back(error, where);
          }
        }
      const rfs_mesh::SpatialIndex index(sample->clean, context);
      clean.emplace_back(shape, rfs_mesh::measure_noise(index, context).sigma / sample->spacing);
    }
    for (const auto& kind : kinds) {
      std::printf(
          "\n%s, %zu points: figure over true (median error of the field); * noise above a third of the "
          "thickness\n  %-20s",
          kind.c_str(), size, "spacings");
      for (const double share : shares) std::printf("%14g", share);
      std::printf("\n");
      for (const auto& shape : shapes) {
        std::printf("  %-20s", shape.c_str());
        for (const double share : shares) {
          char name[64];
          std::snprintf(name, sizeof name, "%s %g", kind.c_str(), share);
          const Row& row = rows[shape][name];
          std::printf("  %5.2f (%.2f)%c", row.figure, row.field, row.counts ? ' ' : '*');
        }
        std::printf("\n");
      }
    }
    std::printf("\nclean, %zu points: figure in spacings\n ", size);
    for (const auto& [shape, sigma] : clean) std::printf(" %s %.3f", shape.c_str(), sigma);
    std::printf("\n");
  }
  std::printf("\nerrors\n");
  for (const auto& kind : kinds) {
    summarise((kind + " figure").c_str(), figures[kind]);
    summarise((kind + " field").c_str(), fields[kind]);
  }
  summarise("figure, too thin", beyond);
  std::printf("  %.2f s in all\n", seconds);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return tell_failures("noise_bench", run, argc, argv);
}
