#include "rfsmooth/rfs_mesh/mesh.h"

#include <algorithm>

#include <fmt/format.h>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Rows from (row, item) pairs: `visit` calls its argument once per pair, the same way each time it is
/// called.
template <class Visit>
Adjacency rows_of(std::size_t n, Visit&& visit) {
  Adjacency rows;
  rows.start.assign(n + 1, 0);
  visit([&](Index row, Index) { ++rows.start[row + 1]; });
  for (std::size_t i = 0; i < n; ++i) rows.start[i + 1] += rows.start[i];
  rows.items.resize(rows.start[n]);
  std::vector<Index> next(rows.start.begin(), rows.start.end() - 1);
  visit([&](Index row, Index item) { rows.items[next[row]++] = item; });
  return rows;
}

/// Sorts every row and drops repeated items.
void sort_unique(Adjacency& rows, const Context& context) {
  std::vector<Index> kept(rows.size() + 1, 0);
  for_each_index(context, rows.size(), [&](std::size_t i) {
    const auto first = rows.items.begin() + rows.start[i], last = rows.items.begin() + rows.start[i + 1];
    std::sort(first, last);
    kept[i + 1] = Index(std::unique(first, last) - first);
  });
  for (std::size_t i = 0; i < rows.size(); ++i) kept[i + 1] += kept[i];
  for (std::size_t i = 0; i < rows.size(); ++i)  // forwards and in place: rows only move towards the front
    std::copy_n(rows.items.begin() + rows.start[i], kept[i + 1] - kept[i], rows.items.begin() + kept[i]);
  rows.items.resize(kept.back());
  rows.items.shrink_to_fit();
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
  Adjacency rows = rows_of(n, [&](auto&& emit) {
    for (const Edge& e : edges) both_ways(e[0], e[1], emit);
  });
  sort_unique(rows, context);
  return rows;
}

void rebuild_adjacency(Mesh& mesh, const Context& context) {
  mesh.one_ring = rows_of(mesh.positions.size(), [&](auto&& emit) {
    for (const Face& f : mesh.faces)
      for (int k = 0; k < 3; ++k) both_ways(f[k], f[(k + 1) % 3], emit);
    for (const Edge& e : mesh.loose_edges) both_ways(e[0], e[1], emit);
  });
  sort_unique(mesh.one_ring, context);
}

Adjacency vertex_faces(const Mesh& mesh, const Context&) {
  return rows_of(mesh.positions.size(), [&](auto&& emit) {
    for (Index f = 0; f < mesh.faces.size(); ++f)
      for (const Index v : mesh.faces[f]) emit(v, f);
  });
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
