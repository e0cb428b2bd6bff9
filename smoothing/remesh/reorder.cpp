#include "smoothing/remesh/reorder.h"

#include <algorithm>

#include "base/morton.h"
#include "base/parallel.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;
using rfsmooth::Mesh;

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

Reordered reorder(const Mesh& mesh, const Context& context) {
  const std::size_t n = mesh.positions.size();
  struct Box {
    Vector3d low, high;
  };
  const Vector3d any = n == 0 ? Vector3d(Vector3d::Zero()) : mesh.positions.front();
  const Box box = reduce_blocks(
      context, n, Box{any, any},
      [&](std::size_t begin, std::size_t end) {
        Box part{any, any};
        for (std::size_t i = begin; i < end; ++i) {
          part.low = part.low.cwiseMin(mesh.positions[i]);
          part.high = part.high.cwiseMax(mesh.positions[i]);
        }
        return part;
      },
      [](const Box& a, const Box& b) {
        return Box{a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
      });
  const double extent = (box.high - box.low).maxCoeff();
  const double to_cell = extent > 0 ? kMortonCells / extent : 0;
  struct Keyed {
    std::uint64_t code;
    Index vertex;
  };
  std::vector<Keyed> keyed(n);
  for_each_index(context, n, [&](std::size_t i) {
    keyed[i] = {rfsmooth::morton_code(mesh.positions[i], box.low, to_cell), Index(i)};
  });
  parallel_sort(context, keyed, [](const Keyed& a, const Keyed& b) {
    return a.code != b.code ? a.code < b.code : a.vertex < b.vertex;
  });

  Reordered out;
  out.place.resize(n);
  out.mesh.positions.resize(n);
  for_each_index(context, n, [&](std::size_t k) {
    out.place[keyed[k].vertex] = Index(k);
    out.mesh.positions[k] = mesh.positions[keyed[k].vertex];
  });
  out.mesh.faces.resize(mesh.faces.size());
  for_each_index(context, mesh.faces.size(), [&](std::size_t f) {
    for (std::size_t c = 0; c < 3; ++c) out.mesh.faces[f][c] = out.place[mesh.faces[f][c]];
  });
  for (const Edge& e : mesh.loose_edges) {
    const Index a = out.place[e[0]], b = out.place[e[1]];
    out.mesh.loose_edges.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(out.mesh.loose_edges.begin(), out.mesh.loose_edges.end());
  // The rows move with their vertices; only their items have to be sorted again.
  Adjacency& ring = out.mesh.one_ring;
  ring.start.resize(n + 1);
  ring.start[0] = 0;
  for (std::size_t k = 0; k < n; ++k)
    ring.start[k + 1] = ring.start[k] + Index(mesh.one_ring.degree(keyed[k].vertex));
  ring.items.resize(ring.start[n]);
  for_each_index(context, n, [&](std::size_t k) {
    auto to = ring.items.begin() + ring.start[k];
    for (const Index j : mesh.one_ring[keyed[k].vertex]) *to++ = out.place[j];
    std::sort(ring.items.begin() + ring.start[k], to);
  });
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
