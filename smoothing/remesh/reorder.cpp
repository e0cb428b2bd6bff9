#include "smoothing/remesh/reorder.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "base/morton.h"
#include "base/parallel.h"
#include "rfs_mesh/corners.h"

namespace rfsmooth::smoothing {

bool is_scattered(const Mesh& mesh, const Context& context) {
  // Smaller meshes fit the cache; 16384 vertices further on, a neighbour has left a core's own cache.
  // Measured at 1M vertices in random order: reordering costs as much as it saves in about three explicit
  // steps.
  constexpr std::size_t kLarge = 100000, kFar = 16384;
  const Adjacency& rows = mesh.one_ring;
  if (rows.size() < kLarge) return false;
  const auto far = sum_over(context, rows.size(), std::size_t{0}, [&](std::size_t i) {
    std::size_t count = 0;
    for (const Index j : rows[i]) count += (j > i ? j - i : i - j) > kFar;
    return count;
  });
  return 2 * far > rows.items.size();
}

namespace {

/// The vertices in Morton order.
std::vector<Index> in_order_of_space(const Mesh& mesh, const Context& context) {
  const std::size_t n = mesh.positions.size();
  const auto box = reduce_blocks(
      context, n, Eigen::AlignedBox3d(),
      [&](std::size_t begin, std::size_t end) {
        Eigen::AlignedBox3d part;
        for (std::size_t i = begin; i < end; ++i) part.extend(mesh.positions[i]);
        return part;
      },
      [](const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) { return a.merged(b); });
  const double extent = box.isEmpty() ? 0 : box.sizes().maxCoeff();
  return morton_order<Index>(
      n, [&](std::size_t i) { return mesh.positions[i]; }, box.min(), extent, [](Index, Index) { return 0; },
      context);
}

/// The rows move with their vertices; only their items have to be sorted again.
Adjacency moved(const Adjacency& rows, const std::vector<Index>& order, const std::vector<Index>& place,
                const Context& context) {
  const std::size_t n = rows.size();
  Adjacency out;
  out.start.resize(n + 1);
  out.start[0] = 0;
  for (std::size_t k = 0; k < n; ++k) out.start[k + 1] = out.start[k] + Index(rows.degree(order[k]));
  out.items.resize(out.start[n]);
  for_each_index(context, n, [&](std::size_t k) {
    auto to = out.items.begin() + out.start[k];
    for (const Index j : rows[order[k]]) *to++ = place[j];
    std::sort(out.items.begin() + out.start[k], to);
  });
  return out;
}

}  // namespace

Reordered reorder(const Mesh& mesh, const Context& context) {
  const std::size_t n = mesh.positions.size();
  const std::vector<Index> order = in_order_of_space(mesh, context);
  Reordered out;
  out.place.resize(n);
  out.mesh.positions.resize(n);
  for_each_index(context, n, [&](std::size_t k) {
    out.place[order[k]] = Index(k);
    out.mesh.positions[k] = mesh.positions[order[k]];
  });
  out.mesh.faces.resize(mesh.faces.size());
  for_each_index(context, mesh.faces.size(), [&](std::size_t f) {
    for (std::size_t c = 0; c < 3; ++c) out.mesh.faces[f][c] = out.place[mesh.faces[f][c]];
  });
  for (const Edge& e : mesh.loose_edges)
    out.mesh.loose_edges.push_back(rfs_mesh::edge_between(out.place[e[0]], out.place[e[1]]));
  std::sort(out.mesh.loose_edges.begin(), out.mesh.loose_edges.end());
  out.mesh.one_ring = moved(mesh.one_ring, order, out.place, context);
  return out;
}

Constraints reorder(const Constraints& constraints, const std::vector<Index>& place) {
  Constraints out = constraints;
  for (HardConstraint& c : out.hard)
    if (c.vertex < place.size()) c.vertex = place[c.vertex];
  if (constraints.strength.size() == place.size())
    for (std::size_t i = 0; i < place.size(); ++i) out.strength[place[i]] = constraints.strength[i];
  return out;
}

}  // namespace rfsmooth::smoothing
