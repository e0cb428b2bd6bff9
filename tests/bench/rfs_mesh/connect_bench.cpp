// The connection stage: quality of the RFS-mesh on the virtual sphere and the thin plate beside the marks of
// the project, proportions on clean shapes, and time and memory on a large cloud beside CGAL's sequential
// Delaunay + Kruskal.
//
//   connect_bench            everything, a large cloud of 1e6 points
//   connect_bench N          with N points in the large cloud
//
// Spacing here is sqrt(area / n) of the clean cloud.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>

#include <fmt/format.h>
#include <sys/resource.h>

#include "rfsmooth/rfs_mesh/edge_swap.h"
#include "rfsmooth/rfs_mesh/measure.h"
#include "rfsmooth/rfs_mesh/rfs_mesh.h"

#include "../../support/shapes.h"
#ifdef RFSMOOTH_BENCH_CGAL
#include "peers/emst_cgal.h"
#include "peers/hull_cgal.h"
#endif

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

std::vector<double> flat(const Positions& points) {
  std::vector<double> xyz;
  for (const auto& p : points) xyz.insert(xyz.end(), {p[0], p[1], p[2]});
  return xyz;
}

/// Noise added, in Morton order as the pipeline hands points over; `source[i]` is the clean row of point i.
struct Noisy {
  Positions points;
  std::vector<std::size_t> source;
};

Noisy with_noise(const Positions& clean, double sigma, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Positions moved = clean;
  for (auto& p : moved) {
    const double x = normal(engine), y = normal(engine), z = normal(engine);
    p += sigma * Eigen::Vector3d(x, y, z);
  }
  const WorkingCloud cloud = make_working_cloud(flat(moved).data(), moved.size(), {}).value();
  Noisy noisy{cloud.points, std::vector<std::size_t>(cloud.points.size())};
  for (auto& p : noisy.points) p += cloud.origin;
  for (std::size_t i = 0; i < moved.size(); ++i) noisy.source[cloud.of_input[i]] = i;
  return noisy;
}

void print_proportions(const Connection& c) {
  const double n = double(c.mesh.positions.size());
  fmt::print("  F/n {:.2f}  E/n {:.2f}  SDG/n {:.2f}  bridges {}  faceless {:.2f} %\n",
             double(c.mesh.faces.size()) / n, double(c.mesh.edge_count()) / n, double(c.sdg.size()) / n,
             c.bridges.size(), 100 * double(c.faceless) / n);
}

#ifdef RFSMOOTH_BENCH_CGAL
void virtual_sphere() {
  fmt::print(
      "virtual sphere, 10,000 Poisson-disk points: found = edges of the Delaunay triangulation of the noisy\n"
      "points projected onto the sphere; marks >= 0.9, 0.8, 0.65, 0.4 at 0, 0.5, 1, 3; long < 1 %, 5 %\n");
  const test::Shape sphere = test::unit_sphere();
  const Positions clean = test::poisson_points(sphere, 10000, 1);
  const double unit = std::sqrt(sphere.area / double(clean.size()));
  for (const double noise : {0.0, 0.5, 1.0, 2.0, 3.0}) {
    const Noisy noisy = with_noise(clean, noise * unit, 2);
    Positions projected = noisy.points;
    for (auto& p : projected) p.normalize();
    const auto truth = bench::peers::hull_edges_cgal(flat(projected).data(), projected.size());
    const Connection c = connect(noisy.points, {}, {}).value();
    std::size_t found = 0, far = 0;
    for (Index a = 0; a < projected.size(); ++a)
      for (const Index b : c.mesh.one_ring[a]) {
        if (b < a) continue;
        found += std::binary_search(truth.begin(), truth.end(), std::array<std::uint32_t, 2>{a, b});
        far += (projected[a] - projected[b]).norm() > 3 * unit;
      }
    fmt::print("  noise {:.1f} (measured {:.2f})  found {:.3f}  long {:.2f} %", noise, c.noise.sigma / unit,
               double(found) / double(truth.size()), 100 * double(far) / double(c.mesh.edge_count()));
    print_proportions(c);
  }
}
#endif

void thin_plate() {
  fmt::print(
      "thin plate, 3 spacings thick, 2 x 10,000 points: edges that join the sides away from the rim; mark < "
      "0.1 %\n");
  constexpr double kUnit = 0.01;
  Positions clean;
  for (const bool top : {false, true})
    for (Eigen::Vector3d p : test::poisson_points(test::plane(), 10000, top ? 2 : 1)) {
      p[2] = top ? 3 * kUnit : 0;
      clean.push_back(p);
    }
  for (const double noise : {0.0, 0.3, 0.5}) {
    const Noisy noisy = with_noise(clean, noise * kUnit, 3);
    const Connection c = connect(noisy.points, {}, {}).value();
    const auto at_rim = [&](Index v) {
      const auto& p = noisy.points[v];
      return std::min({p[0], p[1], 1 - p[0], 1 - p[1]}) < 6 * kUnit;
    };
    std::size_t inner = 0, crossing = 0;
    for (Index a = 0; a < noisy.points.size(); ++a)
      for (const Index b : c.mesh.one_ring[a])
        if (a < b && !at_rim(a) && !at_rim(b)) {
          ++inner;
          crossing += clean[noisy.source[a]][2] != clean[noisy.source[b]][2];
        }
    fmt::print("  noise {:.1f}  crossing {:.3f} %", noise, 100 * double(crossing) / double(inner));
    print_proportions(c);
  }
}

void clean_shapes() {
  fmt::print("clean shapes, 20,000 points\n");
  for (const test::Shape& shape : test::clean_shapes())
    for (const bool even : {false, true}) {
      const Positions points =
          even ? test::poisson_points(shape, 20000, 1) : test::random_points(shape, 20000, 1);
      fmt::print("  {:7} {:12}", shape.name, even ? "Poisson-disk" : "random");
      print_proportions(connect(with_noise(points, 0, 1).points, {}, {}).value());
    }
}

double wall() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_utime.tv_sec) + 1e-6 * double(usage.ru_utime.tv_usec);
}

double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * double(usage.ru_maxrss);
}

void large_cloud(std::size_t n) {
  const double unit = std::sqrt(4 * M_PI / double(n));
  const Positions points = with_noise(test::random_points(test::unit_sphere(), n, 1), 0.3 * unit, 2).points;
  const double before = peak_bytes();
  double w = wall(), c = cpu();
  Connection connection = connect(points, {}, {}).value();
  const double ours = wall() - w, ours_cpu = cpu() - c;
  fmt::print(
      "{} noisy surface points, all cores: {:.2f} s, CPU {:.2f} s, {:.0f} bytes a point above what was in "
      "use\n",
      n, ours, ours_cpu, (peak_bytes() - before) / double(n));
  for (const Seconds& s : connection.seconds) fmt::print("  {:15} {:.2f} s\n", s.stage, s.seconds);
  w = wall();
  const std::size_t swaps = swap_edges(connection.mesh, {}, {});
  fmt::print("  {:15} {:.2f} s, {} swaps\n", "one swap pass", wall() - w, swaps);
#ifdef RFSMOOTH_BENCH_CGAL
  const auto xyz = flat(points);
  w = wall();
  c = cpu();
  bench::peers::emst_length_cgal(xyz.data(), n, false);
  const double theirs = wall() - w;
  fmt::print(
      "  CGAL sequential Delaunay + Kruskal {:.2f} s, CPU {:.2f} s; ratio wall {:.2f}, CPU {:.2f} (mark 0.5 "
      "at four threads)\n",
      theirs, cpu() - c, ours / theirs, ours_cpu / (cpu() - c));
#endif
}

}  // namespace

int main(int argc, char** argv) {
  clean_shapes();
#ifdef RFSMOOTH_BENCH_CGAL
  virtual_sphere();
#endif
  thin_plate();
  large_cloud(argc > 1 ? std::size_t(std::atof(argv[1])) : 1000000);
}
