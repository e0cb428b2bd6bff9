#include "rfsmooth/rfs_mesh/mesh.h"

#include <algorithm>
#include <memory>

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

/// An item and the row it belongs to.
template <class Item>
struct Placed {
  Index row;
  Item item;
};

/// Rows of n from (row, item) pairs: `visit(s, emit)` passes the pairs of source s to `emit`, the same way
/// each time; `append(row, first, last, items)` puts a row's items, in the order of their sources, into the
/// adjacency.
///
/// The pairs are dealt into buckets of rows that fit the cache, in order and without locks; then every bucket
/// is finished by itself. O(pairs); memory for the pairs once more.
template <class Item, class Visit, class Append>
Adjacency rows_from(std::size_t n, std::size_t sources, const Context& context, Visit&& visit,
                    Append&& append) {
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
  std::vector<std::vector<Index>> finished(buckets);
  for_blocks(context, n, bucket, [&](std::size_t begin, std::size_t end) {
    const std::size_t b = begin / bucket, from = place[b * chunks], to = place[(b + 1) * chunks];
    std::vector<Index> start(end - begin + 1, 0);
    for (std::size_t k = from; k < to; ++k) ++start[dealt[k].row - begin + 1];
    for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
    std::vector<Item> items(to - from);
    std::vector<Index> next(start.begin(), start.end() - 1);
    for (std::size_t k = from; k < to; ++k) items[next[dealt[k].row - begin]++] = dealt[k].item;
    finished[b].reserve(to - from);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t before = finished[b].size();
      append(Index(i), items.data() + start[i - begin], items.data() + start[i - begin + 1], finished[b]);
      rows.start[i + 1] = Index(finished[b].size() - before);
    }
  });
  prefix_sum(rows.start, context);
  rows.items.resize(rows.start[n]);
  for_blocks(context, n, bucket, [&](std::size_t begin, std::size_t) {
    std::vector<Index>& items = finished[begin / bucket];
    std::copy(items.begin(), items.end(), rows.items.begin() + rows.start[begin]);
    items = {};
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
  return rows_from<Index>(
      n, edges.size(), context,
      [&](std::size_t s, auto&& emit) {
        const Edge& e = edges[s];
        if (e[0] == e[1]) return;
        emit(e[0], e[1]);
        emit(e[1], e[0]);
      },
      [](Index, Index* first, Index* last, std::vector<Index>& items) {
        std::sort(first, last);
        items.insert(items.end(), first, std::unique(first, last));
      });
}

void rebuild_adjacency(Mesh& mesh, const Context& context) {
  using Others = std::array<Index, 2>;  // of a face; of a loose edge its other end twice
  const std::size_t faces = mesh.faces.size();
  mesh.one_ring = rows_from<Others>(
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
      [](Index row, const Others* first, const Others* last, std::vector<Index>& items) {
        constexpr std::size_t kShort = 64;
        std::array<Index, kShort> ring;
        std::size_t size = 0;
        if (std::size_t(last - first) <= kShort / 2) {
          for (const Others* o = first; o != last; ++o)
            for (const Index v : *o)
              if (v != row) size = insert_sorted(ring.data(), size, v);
          items.insert(items.end(), ring.data(), ring.data() + size);
          return;
        }
        std::vector<Index> all;
        for (const Others* o = first; o != last; ++o) all.insert(all.end(), o->begin(), o->end());
        all.erase(std::remove(all.begin(), all.end(), row), all.end());
        std::sort(all.begin(), all.end());
        items.insert(items.end(), all.begin(), std::unique(all.begin(), all.end()));
      });
}

Adjacency vertex_faces(std::size_t n, const std::vector<Face>& faces, const Context& context) {
  return rows_from<Index>(
      n, faces.size(), context,
      [&](std::size_t f, auto&& emit) {
        for (const Index v : faces[f]) emit(v, Index(f));
      },
      [](Index, const Index* first, const Index* last, std::vector<Index>& items) {
        items.insert(items.end(), first, last);
      });
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
