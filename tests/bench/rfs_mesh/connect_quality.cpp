#include "tests/bench/rfs_mesh/connect_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <rfsmooth/connect.h>

#include "rfs_mesh/measure.h"
#include "rfs_mesh/search/neighbors.h"
#include "tests/bench/quality/data/closest.h"
#include "tests/bench/quality/data/dataset.h"
#include "tests/support/shapes.h"
#ifdef RFSMOOTH_BENCH_CGAL
#include "tests/bench/peers/hull_cgal.h"
#endif

namespace rfsmooth::bench {

using namespace rfs_mesh;
using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<double> flat(const Positions& points) {
  std::vector<double> xyz;
  xyz.reserve(3 * points.size());
  for (const auto& p : points) xyz.insert(xyz.end(), {p[0], p[1], p[2]});
  return xyz;
}

Noisy with_noise(const Positions& clean, double sigma, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Positions moved = clean;
  for (auto& p : moved) {
    const double x = normal(engine), y = normal(engine), z = normal(engine);
    p += sigma * Vector3d(x, y, z);
  }
  const WorkingCloud cloud = make_working_cloud(flat(moved).data(), moved.size(), {}).value();
  Noisy noisy{cloud.points, std::vector<std::size_t>(cloud.points.size())};
  for (auto& p : noisy.points) p += cloud.origin;
  for (std::size_t i = 0; i < moved.size(); ++i) noisy.source[cloud.of_input[i]] = i;
  return noisy;
}

namespace {

void print_proportions(const Connection& c) {
  const double n = double(c.mesh.positions.size());
  fmt::print("  F/n {:.2f}  E/n {:.2f}  SDG/n {:.2f}  bridges {}  faceless {:.2f} %\n",
             double(c.mesh.faces.size()) / n, double(c.mesh.edge_count()) / n, double(c.sdg.size()) / n,
             c.bridges.size(), 100 * double(c.faceless) / n);
}

/// Calls `visit(a, b)` for every edge of the mesh, a < b.
template <class Visit>
void for_edges(const Mesh& mesh, Visit&& visit) {
  for (Index a = 0; a < mesh.positions.size(); ++a)
    for (const Index b : mesh.one_ring[a])
      if (a < b) visit(a, b);
}

void virtual_sphere() {
#ifdef RFSMOOTH_BENCH_CGAL
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
    const auto truth = peers::hull_edges_cgal(flat(projected).data(), projected.size());
    const Connection c = connect(noisy.points, {}, {}).value();
    std::size_t found = 0, far = 0;
    for_edges(c.mesh, [&](Index a, Index b) {
      found += std::binary_search(truth.begin(), truth.end(), std::array<std::uint32_t, 2>{a, b});
      far += (projected[a] - projected[b]).norm() > 3 * unit;
    });
    fmt::print("  noise {:.1f} (measured {:.2f})  found {:.3f}  long {:.2f} %", noise, c.noise.sigma / unit,
               double(found) / double(truth.size()), 100 * double(far) / double(c.mesh.edge_count()));
    print_proportions(c);
  }
#endif
}

void thin_plate() {
  fmt::print(
      "thin plate, 3 spacings thick, 2 x 10,000 points: edges that join the sides away from the rim; mark < "
      "0.1 %\n");
  constexpr double kUnit = 0.01;
  Positions clean;
  for (const bool top : {false, true})
    for (Vector3d p : test::poisson_points(test::plane(), 10000, top ? 2 : 1)) {
      p[2] = top ? 3 * kUnit : 0;
      clean.push_back(p);
    }
  for (const double noise : {0.0, 0.3, 0.5})
    for (const unsigned seed : {3u, 4u}) {
      if (noise == 0 && seed > 3) continue;
      const Noisy noisy = with_noise(clean, noise * kUnit, seed);
      const Connection c = connect(noisy.points, {}, {}).value();
      const auto at_rim = [&](Index v) {
        const auto& p = noisy.points[v];
        return std::min({p[0], p[1], 1 - p[0], 1 - p[1]}) < 6 * kUnit;
      };
      std::size_t inner = 0, crossing = 0;
      for_edges(c.mesh, [&](Index a, Index b) {
        if (at_rim(a) || at_rim(b)) return;
        ++inner;
        crossing += clean[noisy.source[a]][2] != clean[noisy.source[b]][2];
      });
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

/// The noisy points projected onto the true surface, and its normals there.
struct Projected {
  Positions at;
  std::vector<Vector3d> normals;
};

Projected project(const Positions& points, const Mesh& mesh, const ClosestTree& surface) {
  Projected projected;
  for (const Vector3d& p : points) {
    const ClosestTree::Hit hit = surface.nearest(p);
    const Face& f = mesh.faces[hit.primitive];
    projected.at.push_back(hit.point);
    projected.normals.push_back((mesh.positions[f[1]] - mesh.positions[f[0]])
                                    .cross(mesh.positions[f[2]] - mesh.positions[f[0]])
                                    .normalized());
  }
  return projected;
}

/// The edges {a < b} that a Delaunay triangulation in the true tangent plane gives both ends: the sides of
/// a's Voronoi cell among the 24 nearest projected points whose normals are within 60 degrees of its own.
std::vector<std::array<Index, 2>> tangent_delaunay(const Projected& truth) {
  const SpatialIndex index(truth.at, {});
  const NeighborTable near = index.nearest(24, {});
  std::vector<std::array<Index, 2>> half;
  for (Index a = 0; a < truth.at.size(); ++a) {
    const Vector3d n = truth.normals[a], t1 = n.unitOrthogonal(), t2 = n.cross(t1);
    const double r = (truth.at[near[a].end()[-1]] - truth.at[a]).norm();
    struct Corner {
      Vector2d at;
      Index side;  // the neighbour behind the side that starts here
    };
    std::vector<Corner> cell = {{{-r, -r}, kNone}, {{r, -r}, kNone}, {{r, r}, kNone}, {{-r, r}, kNone}};
    for (const Index b : near[a]) {
      if (truth.normals[b].dot(n) < 0.5) continue;
      const Vector3d d = truth.at[b] - truth.at[a];
      const Vector2d to(t1.dot(d), t2.dot(d));
      const double half_way = 0.5 * to.squaredNorm();
      if (!(half_way > 0)) continue;
      std::vector<Corner> cut;
      for (std::size_t k = 0; k < cell.size(); ++k) {
        const Corner &p = cell[k], &q = cell[(k + 1) % cell.size()];
        const double over_p = to.dot(p.at) - half_way, over_q = to.dot(q.at) - half_way;
        const Vector2d between = p.at + (q.at - p.at) * (over_p / (over_p - over_q));
        if (over_p <= 0) cut.push_back(p);
        if (over_p <= 0 && over_q > 0) cut.push_back({between, b});
        if (over_p > 0 && over_q <= 0) cut.push_back({between, p.side});
      }
      cell.swap(cut);
    }
    for (const Corner& c : cell)
      if (c.side != kNone) half.push_back({std::min(a, c.side), std::max(a, c.side)});
  }
  std::sort(half.begin(), half.end());
  std::vector<std::array<Index, 2>> both;
  for (std::size_t i = 0; i + 1 < half.size(); ++i)
    if (half[i] == half[i + 1]) both.push_back(half[i]);
  return both;
}

void development_shapes() {
  fmt::print(
      "development shapes, 10,000 points, noise in percent of the radius: measured = noise measured / true; "
      "of the\n"
      "noisy points projected onto the true surface: found = share of the edges of a Delaunay triangulation "
      "in "
      "the\n"
      "true tangent planes, long = edges over more than 3 spacings, across = edges between true normals more "
      "than 90\n"
      "degrees apart (opposite sheets)\n");
  for (const int percent : {0, 1, 2, 3}) {
    double sum_found = 0, sum_long = 0, sum_across = 0;
    for (const std::string& shape : shape_names()) {
      const auto sample = load_sample(shape, 10000, default_cache());
      const ClosestTree surface(sample->mesh);
      Noise noise;
      noise.sigma = 0.01 * percent;
      const Case c = make_case(sample, noise);
      const Positions points = with_noise(c.noisy, 0, 1).points;
      const Projected truth = project(points, sample->mesh, surface);
      const auto edges = tangent_delaunay(truth);
      const Connection made = connect(points, {}, {}).value();
      std::size_t found = 0, far = 0, across = 0;
      for_edges(made.mesh, [&](Index a, Index b) {
        found += std::binary_search(edges.begin(), edges.end(), std::array<Index, 2>{a, b});
        far += (truth.at[a] - truth.at[b]).norm() > 3 * sample->spacing;
        across += truth.normals[a].dot(truth.normals[b]) < 0;
      });
      const double total = double(made.mesh.edge_count());
      sum_found += double(found) / double(edges.size());
      sum_long += 100 * double(far) / total;
      sum_across += 100 * double(across) / total;
      fmt::print("  {:18} {} %  noise {:.2f} spacings", shape, percent, noise.sigma / sample->spacing);
      if (percent > 0) fmt::print(" (measured {:.2f})", made.noise.sigma / noise.sigma);
      fmt::print("  found {:.3f}  long {:.2f} %  across {:.2f} %", double(found) / double(edges.size()),
                 100 * double(far) / total, 100 * double(across) / total);
      print_proportions(made);
    }
    const double shapes = double(shape_names().size());
    fmt::print("  mean at {} %: found {:.3f}  long {:.2f} %  across {:.2f} %\n", percent, sum_found / shapes,
               sum_long / shapes, sum_across / shapes);
  }
}

}  // namespace

void connection_quality() {
  fmt::print("\n");
  clean_shapes();
  virtual_sphere();
  thin_plate();
  development_shapes();
  std::fflush(stdout);
}

}  // namespace rfsmooth::bench
