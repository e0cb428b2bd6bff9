#include "rfsmooth/rfs_mesh/mesh.h"

#include <algorithm>
#include <atomic>

#include <fmt/format.h>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Adds up start[1..n] in place, blocks in parallel.
void prefix_sum(std::vector<Index>& start, const Context& context) {
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  const std::size_t n = start.size() - 1;
  std::vector<Index> total((n + kBlock - 1) / kBlock + 1, 0);
  for_blocks(context, n, kBlock, [&](std::size_t b, std::size_t e) {
    for (std::size_t i = b + 1; i < e; ++i) start[i + 1] += start[i];
    total[b / kBlock + 1] = start[e];
  });
  for (std::size_t b = 1; b < total.size(); ++b) total[b] += total[b - 1];
  for_blocks(context, n, kBlock, [&](std::size_t b, std::size_t e) {
    for (std::size_t i = b; i < e; ++i) start[i + 1] += total[b / kBlock];
  });
}

/// Rows of n from (row, item) pairs: `visit(s, emit)` passes the pairs of source s to `emit`, the same way
/// each time. Threads take places in a row in any order, so the rows come out right only once sorted.
template <class Visit>
Adjacency unsorted_rows(std::size_t n, std::size_t sources, const Context& context, Visit&& visit) {
  Adjacency rows;
  rows.start.assign(n + 1, 0);
  std::vector<std::atomic<Index>> place(n);
  for_each_index(context, sources, [&](std::size_t s) {
    visit(s, [&](Index row, Index) { place[row].fetch_add(1, std::memory_order_relaxed); });
  });
  for_each_index(context, n, [&](std::size_t i) { rows.start[i + 1] = place[i].load(); });
  prefix_sum(rows.start, context);
  for_each_index(context, n, [&](std::size_t i) { place[i].store(rows.start[i]); });
  rows.items.resize(rows.start[n]);
  for_each_index(context, sources, [&](std::size_t s) {
    visit(s, [&](Index row, Index item) {
      rows.items[place[row].fetch_add(1, std::memory_order_relaxed)] = item;
    });
  });
  return rows;
}

void sort_rows(Adjacency& rows, const Context& context) {
  for_each_index(context, rows.size(), [&](std::size_t i) {
    std::sort(rows.items.begin() + rows.start[i], rows.items.begin() + rows.start[i + 1]);
  });
}

/// Sorts every row and drops repeated items.
void sort_unique(Adjacency& rows, const Context& context) {
  std::vector<Index> kept(rows.size() + 1, 0);
  for_each_index(context, rows.size(), [&](std::size_t i) {
    const auto first = rows.items.begin() + rows.start[i], last = rows.items.begin() + rows.start[i + 1];
    std::sort(first, last);
    kept[i + 1] = Index(std::unique(first, last) - first);
  });
  prefix_sum(kept, context);
  std::vector<Index> items(kept.back());
  for_each_index(context, rows.size(), [&](std::size_t i) {
    std::copy_n(rows.items.begin() + rows.start[i], kept[i + 1] - kept[i], items.begin() + kept[i]);
  });
  rows.items = std::move(items);
  rows.start = std::move(kept);
}

template <class Emit>
void both_ways(Index a, Index b, Emit&& emit) {
  if (a == b) return;
  emit(a, b);
  emit(b, a);
}

}  // namespace

Adjacency make_adjacency(std::size_t n, const std::vector<Edge>& edges, const Context& context) {
  Adjacency rows = unsorted_rows(n, edges.size(), context, [&](std::size_t s, auto&& emit) {
    both_ways(edges[s][0], edges[s][1], emit);
  });
  sort_unique(rows, context);
  return rows;
}

void rebuild_adjacency(Mesh& mesh, const Context& context) {
  const std::size_t faces = mesh.faces.size();
  mesh.one_ring = unsorted_rows(mesh.positions.size(), faces + mesh.loose_edges.size(), context,
                                [&](std::size_t s, auto&& emit) {
                                  if (s >= faces) {
                                    const Edge& e = mesh.loose_edges[s - faces];
                                    return both_ways(e[0], e[1], emit);
                                  }
                                  const Face& f = mesh.faces[s];
                                  for (int k = 0; k < 3; ++k) both_ways(f[k], f[(k + 1) % 3], emit);
                                });
  sort_unique(mesh.one_ring, context);
}

Adjacency vertex_faces(std::size_t n, const std::vector<Face>& faces, const Context& context) {
  Adjacency rows = unsorted_rows(n, faces.size(), context, [&](std::size_t f, auto&& emit) {
    for (const Index v : faces[f]) emit(v, Index(f));
  });
  sort_rows(rows, context);
  return rows;
}

Adjacency vertex_faces(const Mesh& mesh, const Context& context) {
  return vertex_faces(mesh.positions.size(), mesh.faces, context);
}

std::vector<std::string> check(const Mesh& mesh) {
  std::vector<std::string> wrong;
  const std::size_t n = mesh.positions.size();
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& v = mesh.faces[f];
    if (v[0] >= n || v[1] >= n || v[2] >= n) wrong.push_back(fmt::format("face {} has a corner >= {}", f, n));
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
      wrong.push_back(fmt::format("face {} repeats a corner", f));
  }
  for (std::size_t e = 0; e < mesh.loose_edges.size(); ++e) {
    const Edge& edge = mesh.loose_edges[e];
    if (edge[0] >= edge[1] || edge[1] >= n)
      wrong.push_back(fmt::format("loose edge {} is not a < b < {}", e, n));
    if (e > 0 && !(mesh.loose_edges[e - 1] < edge))
      wrong.push_back(fmt::format("loose edge {} is out of order", e));
  }
  if (mesh.one_ring.size() != n)
    wrong.push_back(fmt::format("one_ring has {} rows, not {}", mesh.one_ring.size(), n));
  if (!wrong.empty()) return wrong;
  Mesh fresh;
  fresh.positions = mesh.positions;
  fresh.faces = mesh.faces;
  fresh.loose_edges = mesh.loose_edges;
  rebuild_adjacency(fresh, Context{});
  if (fresh.one_ring.start != mesh.one_ring.start || fresh.one_ring.items != mesh.one_ring.items)
    wrong.emplace_back("one_ring does not match the faces and loose edges; call rebuild_adjacency");
  return wrong;
}

}  // namespace rfsmooth::rfs_mesh
