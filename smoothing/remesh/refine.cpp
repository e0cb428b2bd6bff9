#include "smoothing/remesh/refine.h"

#include <algorithm>
#include <stdexcept>

#include "base/parallel.h"
#include "rfs_mesh/corners.h"
#include "smoothing/integrators/solver.h"
#include "smoothing/modifiers/boundary.h"
#include "smoothing/operators/divided_difference.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;
using rfs_mesh::edge_between;

namespace {

std::vector<Edge> face_edges(const Mesh& mesh) {
  std::vector<Edge> edges;
  for (const Face& f : mesh.faces)
    for (int k = 0; k < 3; ++k) edges.push_back(edge_between(f[k], f[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// A copy of the mesh in which the two sides of every curve edge have nothing to do with each other: a vertex
/// of a curve is there once for every fan of faces between curves. The first keeps its number, copies follow
/// behind all others.
Mesh cut_along(const Mesh& mesh, const std::vector<Edge>& curve, const Context& context) {
  std::vector<Edge> cuts;
  for (const Edge& e : curve) cuts.push_back(edge_between(e[0], e[1]));
  std::sort(cuts.begin(), cuts.end());
  const Adjacency around = vertex_faces(mesh, context);
  Mesh cut = mesh;
  std::vector<char> done(mesh.positions.size(), 0);
  for (const Edge& e : cuts)
    for (const Index v : e) {
      if (done[v] != 0) continue;
      done[v] = 1;
      std::vector<Index> left(around[v].begin(), around[v].end()), fan;
      for (bool first = true; !left.empty(); first = false) {
        const Index number = first ? v : Index(cut.positions.size());
        if (!first) cut.positions.push_back(mesh.positions[v]);
        fan.assign(1, left.front());
        left.erase(left.begin());
        for (std::size_t at = 0; at < fan.size(); ++at)
          for (const Index u : mesh.faces[fan[at]]) {
            if (u == v || std::binary_search(cuts.begin(), cuts.end(), edge_between(u, v))) continue;
            const auto beside = std::stable_partition(
                left.begin(), left.end(), [&](Index f) { return !rfs_mesh::has_corner(mesh.faces[f], u); });
            fan.insert(fan.end(), beside, left.end());
            left.erase(beside, left.end());
          }
        for (const Index f : fan) std::replace(cut.faces[f].begin(), cut.faces[f].end(), v, number);
      }
    }
  rebuild_adjacency(cut, context);
  return cut;
}

/// Of the cut mesh: the given vertices, all curve vertices and their copies, from `copies` on, stay.
AllowedMoves all_but(std::size_t given, const std::vector<Edge>& curve, std::size_t copies, std::size_t n) {
  std::vector<char> still(n, 0);
  std::fill_n(still.begin(), given, 1);
  std::fill(still.begin() + std::ptrdiff_t(copies), still.end(), 1);
  for (const Edge& e : curve) still[e[0]] = still[e[1]] = 1;
  Constraints constraints;
  for (Index i = 0; i < n; ++i)
    if (still[i] != 0) constraints.hard.push_back({i, HardConstraint::Kind::fixed, Eigen::Vector3d::Zero()});
  return {constraints, n};
}

/// Moves the free vertices to the least energy, A d = -A x over them, on either side of a curve by itself.
void minimise(Mesh& mesh, std::size_t given, const std::vector<Edge>& curve, const RefineOptions& options,
              const Context& context) {
  const Mesh cut = cut_along(mesh, curve, context);
  const std::size_t n = cut.positions.size();
  const AllowedMoves allowed = all_but(given, curve, mesh.positions.size(), n);
  const DividedDifferences differences(cut, options.chart, context);
  Positions b, d(n, Vector3d::Zero());
  differences.apply(cut.positions, b, context);
  for_each_index(context, n, [&](std::size_t i) { b[i] = allowed(i, -b[i]); });
  std::vector<double> diagonal = differences.diagonal(context);
  for (double& v : diagonal)
    if (!(v > 0)) v = 1;
  SolverOptions solver;
  solver.tolerance = options.tolerance;
  const Product product = [&](const Positions& x, Positions& y) {
    differences.apply(x, y, context);
    return sum_over(context, n, 0.0, [&](std::size_t i) { return x[i].dot(y[i]); });
  };
  conjugate_gradients({product, diagonal, diagonal}, b, d, allowed, solver, context);
  for_each_index(context, mesh.positions.size(), [&](std::size_t i) {
    const Vector3d p = mesh.positions[i] + allowed(i, d[i]);
    if (p.allFinite()) mesh.positions[i] = p;
  });
}

/// Given vertices move towards their neighbours' mean, by the wanted length at most.
void take_off_pimples(Mesh& mesh, std::size_t given, const std::vector<Edge>& curve, double longest,
                      const Context& context) {
  std::vector<char> still(mesh.positions.size(), 0);
  for (const Edge& e : curve) still[e[0]] = still[e[1]] = 1;
  const Mesh cut = cut_along(mesh, curve, context);
  const Positions& before = cut.positions;
  const Adjacency& ring = cut.one_ring;
  for_each_index(context, given, [&](std::size_t i) {
    if (still[i] != 0 || ring.degree(i) == 0) return;
    // The bilaplacian's local minimum: x_i such that L x_i equals the neighbours' mean of L x.
    const auto laplace = [&](std::size_t v) {
      Vector3d sum = Vector3d::Zero();
      for (const Index j : ring[v]) sum += before[j];
      return Vector3d(before[v] - sum / double(std::max<std::size_t>(1, ring.degree(v))));
    };
    Vector3d mean = Vector3d::Zero();
    for (const Index j : ring[i]) mean += laplace(j) / double(ring.degree(i));
    Vector3d move = 0.5 * (mean - laplace(i));
    if (move.norm() > longest) move *= longest / move.norm();
    mesh.positions[i] += move;
  });
}

}  // namespace

std::size_t refined_vertices(const Mesh& mesh, int levels) {
  std::size_t vertices = mesh.positions.size(), faces = mesh.faces.size();
  std::size_t edges = mesh.edge_count() - mesh.loose_edges.size();
  for (int level = 0; level < levels; ++level) {
    vertices += edges;
    edges = 2 * edges + 3 * faces;
    faces *= 4;
  }
  return vertices;
}

Mesh split(const Mesh& mesh, std::vector<Edge>& curve, const Context& context) {
  const auto n = Index(mesh.positions.size());
  const std::vector<Edge> edges = face_edges(mesh);
  const auto middle = [&](Index a, Index b) {
    const Edge e = edge_between(a, b);
    const auto at = std::lower_bound(edges.begin(), edges.end(), e);
    if (at == edges.end() || *at != e) throw std::invalid_argument("a sharp edge is not an edge of a face");
    return n + Index(at - edges.begin());
  };
  Mesh fine;
  fine.positions = mesh.positions;
  fine.positions.resize(n + edges.size());
  for_each_index(context, edges.size(), [&](std::size_t e) {
    fine.positions[n + e] = 0.5 * (mesh.positions[edges[e][0]] + mesh.positions[edges[e][1]]);
  });
  fine.faces.resize(4 * mesh.faces.size());
  for_each_index(context, mesh.faces.size(), [&](std::size_t f) {
    const Face& v = mesh.faces[f];
    const Index a = middle(v[0], v[1]), b = middle(v[1], v[2]), c = middle(v[2], v[0]);
    fine.faces[4 * f] = {v[0], a, c};
    fine.faces[4 * f + 1] = {v[1], b, a};
    fine.faces[4 * f + 2] = {v[2], c, b};
    fine.faces[4 * f + 3] = {a, b, c};
  });
  fine.loose_edges = mesh.loose_edges;
  // The four-point scheme along the curves; at their ends and junctions the middle.
  const Adjacency along = rfsmooth::make_adjacency(n, curve, context);
  std::vector<Edge> halves;
  for (const Edge& e : curve) {
    const Index m = middle(e[0], e[1]);
    const auto beyond = [&](Index at, Index from) {
      const auto row = along[at];
      return row.size() == 2 ? (row[0] == from ? row[1] : row[0]) : kNone;
    };
    const Index before = beyond(e[0], e[1]), after = beyond(e[1], e[0]);
    if (before != kNone && after != kNone)
      fine.positions[m] = (9 * (mesh.positions[e[0]] + mesh.positions[e[1]]) -
                           (mesh.positions[before] + mesh.positions[after])) /
                          16;
    halves.push_back({e[0], m});
    halves.push_back({m, e[1]});
  }
  curve = std::move(halves);
  rebuild_adjacency(fine, context);
  return fine;
}

Result<Mesh> refine(const Mesh& mesh, const RefineOptions& options, const Context& context,
                    const std::vector<Edge>& sharp) {
  return guarded([&] {
    value_or_throw(validate(options));
    if (refined_vertices(mesh, options.levels) >= kNone)
      throw Failure({ErrorCode::usage, "the refined mesh would have too many vertices; use fewer levels"});
    Mesh fine = mesh;
    in_arena(context, [&] {
      std::vector<Edge> curve = boundary_edges(mesh);
      curve.insert(curve.end(), sharp.begin(), sharp.end());
      for (int level = 0; level < options.levels; ++level) {
        context.report("refine", double(level) / options.levels);
        fine = split(fine, curve, context);
        minimise(fine, mesh.positions.size(), curve, options, context);
      }
      if (options.pimple > 0)
        take_off_pimples(fine, mesh.positions.size(), curve, options.pimple * length_unit(fine, context),
                         context);
    });
    return fine;
  });
}

}  // namespace rfsmooth::smoothing
