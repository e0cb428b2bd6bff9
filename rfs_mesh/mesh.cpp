#include <algorithm>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include <rfsmooth/mesh.h>

#include "base/collect.h"
#include "base/fail.h"
#include "base/parallel.h"

namespace rfsmooth {

namespace {

/// \throw Failure if rows of so many items together have no place for their starts.
void refuse_too_many(std::size_t items) {
  if (items > std::numeric_limits<Index>::max())
    fail(ErrorCode::usage,
         "{} neighbours in all; a mesh has at most {}: cut the cloud into tiles, or take fewer faces", items,
         std::numeric_limits<Index>::max());
}

/// Adds up start[1..n] in place, blocks in parallel. \throw Failure if the sum is more than an Index holds.
void prefix_sum(std::vector<Index>& start, const Context& context) {
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  const std::size_t n = start.size() - 1;
  refuse_too_many(
      sum_over(context, start.size(), std::size_t{0}, [&](std::size_t i) { return std::size_t(start[i]); }));
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

/// An item and the row it belongs to.
template <class Item>
struct Placed {
  Index row;
  Item item;
};

/// Rows of n from (row, item) pairs: `visit(s, emit)` passes the pairs of source s to `emit`, the same way
/// each time; `finish(row, first, last, out)` writes what becomes of a row's items, given in the order of
/// their sources, to `out` and returns the end; at most kMost for each of them.
///
/// The pairs are dealt into buckets of rows that fit the cache, in order and without locks; then every bucket
/// is finished by itself. O(pairs); memory for the pairs once more.
template <class Item, std::size_t kMost, class Visit, class Finish>
Adjacency rows_from(std::size_t n, std::size_t sources, const Context& context, Visit&& visit,
                    Finish&& finish) {
  const std::size_t bucket = std::max<std::size_t>(1024, n / 1024 + 1), buckets = n / bucket + 1;
  const std::size_t chunk = std::max<std::size_t>(4096, sources / 256 + 1);
  const std::size_t chunks = (sources + chunk - 1) / chunk;
  // place[b * chunks + c]: where the pairs of chunk c for bucket b go.
  std::vector<std::size_t> place(buckets * chunks + 1, 0);
  for_blocks(context, sources, chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<std::size_t> count(buckets, 0);
    for (std::size_t s = begin; s < end; ++s)
      visit(s, [&](Index row, const Item&) { ++count[row / bucket]; });
    for (std::size_t b = 0; b < buckets; ++b) place[b * chunks + begin / chunk + 1] = count[b];
  });
  for (std::size_t k = 1; k < place.size(); ++k) place[k] += place[k - 1];
  // Not a vector: its pages are first touched where they are written, in parallel.
  const std::unique_ptr<Placed<Item>[]> dealt(new Placed<Item>[place.back()]);
  for_blocks(context, sources, chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<std::size_t> next(buckets);
    for (std::size_t b = 0; b < buckets; ++b) next[b] = place[b * chunks + begin / chunk];
    for (std::size_t s = begin; s < end; ++s)
      visit(s, [&](Index row, const Item& item) { dealt[next[row / bucket]++] = {row, item}; });
  });

  Adjacency rows;
  rows.start.assign(n + 1, 0);
  const std::unique_ptr<Index[]> finished(new Index[kMost * place.back()]);  // buckets where their pairs are
  for_blocks(context, n, bucket, [&](std::size_t begin, std::size_t end) {
    const std::size_t b = begin / bucket, from = place[b * chunks], to = place[(b + 1) * chunks];
    std::vector<Index> start(end - begin + 1, 0);
    for (std::size_t k = from; k < to; ++k) ++start[dealt[k].row - begin + 1];
    for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
    std::vector<Item> items(to - from);
    std::vector<Index> next(start.begin(), start.end() - 1);
    for (std::size_t k = from; k < to; ++k) items[next[dealt[k].row - begin]++] = dealt[k].item;
    Index* out = finished.get() + kMost * from;
    for (std::size_t i = begin; i < end; ++i) {
      Index* const row = out;
      out = finish(Index(i), items.data() + start[i - begin], items.data() + start[i - begin + 1], row);
      rows.start[i + 1] = Index(out - row);
    }
  });
  prefix_sum(rows.start, context);
  rows.items.resize(rows.start[n]);
  for_blocks(context, n, bucket, [&](std::size_t begin, std::size_t end) {
    const Index* const first = finished.get() + kMost * place[begin / bucket * chunks];
    std::copy(first, first + (rows.start[end] - rows.start[begin]), rows.items.begin() + rows.start[begin]);
  });
  return rows;
}

/// Inserts v into `size` ascending items, unless it is there; returns the new size. Rings are short.
std::size_t insert_sorted(Index* items, std::size_t size, Index v) {
  std::size_t at = size;
  while (at > 0 && items[at - 1] > v) --at;
  if (at > 0 && items[at - 1] == v) return size;
  for (std::size_t k = size; k > at; --k) items[k] = items[k - 1];
  items[at] = v;
  return size + 1;
}

}  // namespace

Adjacency make_adjacency(std::size_t n, const std::vector<Edge>& edges, const Context& context) {
  return rows_from<Index, 1>(
      n, edges.size(), context,
      [&](std::size_t s, auto&& emit) {
        const Edge& e = edges[s];
        if (e[0] == e[1]) return;
        emit(e[0], e[1]);
        emit(e[1], e[0]);
      },
      [](Index, Index* first, Index* last, Index* out) {
        std::sort(first, last);
        return std::unique_copy(first, last, out);
      });
}

Adjacency joined(const Adjacency& one, const Adjacency& other, const Context& context) {
  const std::size_t n = one.size();
  refuse_too_many(one.items.size() + other.items.size());
  Adjacency rows;
  rows.start.resize(n + 1);
  for_each_index(context, n + 1, [&](std::size_t i) { rows.start[i] = one.start[i] + other.start[i]; });
  rows.items.resize(rows.start[n]);
  for_each_index(context, n, [&](std::size_t i) {
    const auto a = one[i], b = other[i];
    std::merge(a.begin(), a.end(), b.begin(), b.end(), rows.items.begin() + rows.start[i]);
  });
  return rows;
}

std::vector<Edge> edges_of(const Adjacency& graph, const Context& context) {
  return collect<Edge>(context, graph.size(), [&](std::size_t i, auto&& emit) {
    for (const Index j : graph[i])
      if (i < j) emit({Index(i), j});
  });
}

void rebuild_adjacency(Mesh& mesh, const Context& context) {
  using Others = std::array<Index, 2>;  // of a face; of a loose edge its other end twice
  const std::size_t faces = mesh.faces.size();
  mesh.one_ring = rows_from<Others, 2>(
      mesh.positions.size(), faces + mesh.loose_edges.size(), context,
      [&](std::size_t s, auto&& emit) {
        if (s >= faces) {
          const Edge& e = mesh.loose_edges[s - faces];
          emit(e[0], Others{e[1], e[1]});
          emit(e[1], Others{e[0], e[0]});
          return;
        }
        const Face& f = mesh.faces[s];
        emit(f[0], Others{f[1], f[2]});
        emit(f[1], Others{f[2], f[0]});
        emit(f[2], Others{f[0], f[1]});
      },
      [](Index row, const Others* first, const Others* last, Index* out) {
        constexpr std::ptrdiff_t kShort = 32;
        Index* end = out;
        if (last - first <= kShort) {
          for (const Others* o = first; o != last; ++o)
            for (const Index v : *o)
              if (v != row) end = out + insert_sorted(out, std::size_t(end - out), v);
          return end;
        }
        for (const Others* o = first; o != last; ++o) end = std::copy(o->begin(), o->end(), end);
        end = std::remove(out, end, row);
        std::sort(out, end);
        return std::unique(out, end);
      });
}

Adjacency vertex_faces(std::size_t n, const std::vector<Face>& faces, const Context& context) {
  return rows_from<Index, 1>(
      n, faces.size(), context,
      [&](std::size_t f, auto&& emit) {
        for (const Index v : faces[f]) emit(v, Index(f));
      },
      [](Index, const Index* first, const Index* last, Index* out) { return std::copy(first, last, out); });
}

Adjacency vertex_faces(const Mesh& mesh, const Context& context) {
  return vertex_faces(mesh.positions.size(), mesh.faces, context);
}

Adjacency one_ring(const Adjacency& around, const std::vector<Face>& faces, const std::vector<char>& kept,
                   const Context& context) {
  const std::size_t n = around.size();
  Adjacency rows;
  rows.start.assign(n + 1, 0);
  // Every face adds two vertices at most. Not a vector: pages that no row needs are never touched.
  const std::unique_ptr<Index[]> finished(new Index[2 * around.items.size()]);
  for_each_index(context, n, [&](std::size_t i) {
    Index* const row = finished.get() + 2 * std::size_t(around.start[i]);
    std::size_t size = 0;
    for (const Index f : around[i]) {
      if (kept[f] == 0) continue;
      for (const Index v : faces[f])
        if (v != Index(i)) size = insert_sorted(row, size, v);
    }
    rows.start[i + 1] = Index(size);
  });
  prefix_sum(rows.start, context);
  rows.items.resize(rows.start[n]);
  for_each_index(context, n, [&](std::size_t i) {
    std::copy_n(finished.get() + 2 * std::size_t(around.start[i]), rows.degree(i),
                rows.items.begin() + rows.start[i]);
  });
  return rows;
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

}  // namespace rfsmooth
