#include "rfsmooth/smoothing/thinning.h"

#include <algorithm>

#include "rfsmooth/rfs_mesh/neighbors.h"
#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::smoothing {

namespace {

constexpr std::size_t kNear = 3;

enum class State : unsigned char { open, kept, dropped };

}  // namespace

std::vector<Index> thin(const Positions& points, const std::vector<Index>& subset, const Context& context) {
  const std::size_t n = subset.size();
  if (n <= kNear) return {subset.begin(), subset.begin() + std::ptrdiff_t(std::min<std::size_t>(n, 1))};
  Positions at(n);
  for_each_index(context, n, [&](std::size_t s) { at[s] = points[subset[s]]; });
  std::vector<Index> kept =
      thin_all(at, rfs_mesh::SpatialIndex(at, context).nearest(int(kNear), context), context);
  for (Index& k : kept) k = subset[k];
  return kept;
}

std::vector<Index> thin_all(const Positions& at, const rfs_mesh::NeighborTable& near,
                            const Context& context) {
  const std::size_t n = at.size();
  std::vector<double> priority(n);
  std::vector<rfs_mesh::Edge> edges(n * kNear);
  for_each_index(context, n, [&](std::size_t s) {
    // A sum, since two points that are each other's third neighbours would tie.
    priority[s] = 0;
    for (std::size_t k = 0; k < kNear; ++k) {
      const Index t = near[s][k];
      priority[s] += (at[t] - at[s]).squaredNorm();
      edges[s * kNear + k] = {std::min(Index(s), t), std::max(Index(s), t)};
    }
  });
  const rfs_mesh::Adjacency graph = rfs_mesh::make_adjacency(n, edges, context);
  const auto before = [&](std::size_t a, std::size_t b) {
    return priority[a] != priority[b] ? priority[a] > priority[b] : a < b;
  };

  std::vector<State> state(n, State::open);
  for (bool open = true; open;) {
    // Two sweeps against a snapshot each: first the open ones before all their open neighbours are kept, then
    // the neighbours of kept ones are dropped.
    std::vector<State> next = state;
    for_each_index(context, n, [&](std::size_t s) {
      if (state[s] != State::open) return;
      for (const Index t : graph[s])
        if (state[t] == State::open && before(t, s)) return;
      next[s] = State::kept;
    });
    state = next;
    for_each_index(context, n, [&](std::size_t s) {
      if (state[s] != State::open) return;
      for (const Index t : graph[s])
        if (state[t] == State::kept) next[s] = State::dropped;
    });
    state.swap(next);
    open = std::find(state.begin(), state.end(), State::open) != state.end();
  }
  std::vector<Index> kept;
  for (std::size_t s = 0; s < n; ++s)
    if (state[s] == State::kept) kept.push_back(Index(s));
  return kept;
}

}  // namespace rfsmooth::smoothing
