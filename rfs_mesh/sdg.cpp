#include "rfsmooth/rfs_mesh/sdg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "rfsmooth/rfs_mesh/collect.h"
#include "rfsmooth/rfs_mesh/median.h"
#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/rfs_mesh/tangent_plane.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kMostDirections = 32;  ///< vertices of higher degree have no gap worth closing

/// Lengths of the EMST edges within two hops of v: the edges of v, its neighbours and theirs; the first of
/// them where there are more than fit (coincident points are joined to one of them).
template <std::size_t kMost>
std::size_t lengths_around(const Positions& at, const Adjacency& tree, Index v,
                           std::array<double, kMost>& lengths) {
  std::size_t count = 0;
  const auto filled_by = [&](Index a, Index b) {
    lengths[count++] = (at[a] - at[b]).norm();
    return count == kMost;
  };
  for (const Index a : tree[v]) {
    if (filled_by(v, a)) return count;
    for (const Index b : tree[a]) {
      if (b == v) continue;
      if (filled_by(a, b)) return count;
      for (const Index c : tree[b])
        if (c != a && filled_by(b, c)) return count;
    }
  }
  return count;
}

/// Their median.
double local_length(const Positions& at, const Adjacency& tree, Index v) {
  std::array<double, 64> lengths;
  const std::size_t count = lengths_around(at, tree, v, lengths);
  return median(lengths.begin(), lengths.begin() + std::ptrdiff_t(count));
}

/// The rules of sdg.h over one terrain; `graph` is the snapshot they read.
class Rules {
 public:
  Rules(const Terrain& terrain, const std::vector<double>& length, const Adjacency& graph,
        const SdgOptions& options)
      : terrain_(terrain),
        at_(terrain.at),
        length_(length),
        graph_(graph),
        options_(options),
        cos_normal_(std::cos(radians(options.normal_angle))) {}

  /// (A) Where a leaf wants to go on, or kNone.
  Index beyond_leaf(Index v) const {
    if (graph_.degree(v) != 1) return kNone;
    const TangentPlane plane(normal(v));
    const double ahead = plane.angle(at_[v] - at_[graph_[v][0]]);
    const double cones[3] = {options_.leaf_ahead, options_.leaf_aside, 180 - options_.leaf_clearance};
    for (const double cone : cones)
      for (const Index q : terrain_.near[v])
        if (between(ahead, plane.angle(at_[q] - at_[v])) <= radians(cone) &&
            admissible(v, q, options_.leaf_lune))
          return q;
    return kNone;
  }

  /// (B) Whom v wants to reach across its widest gap, or kNone.
  Index across_gap(Index v) const {
    const std::size_t degree = graph_.degree(v);
    if (degree == 0 || degree > kMostDirections) return kNone;
    const TangentPlane plane(normal(v));
    std::array<double, kMostDirections> directions;
    for (std::size_t j = 0; j < degree; ++j) directions[j] = plane.angle(at_[graph_[v][j]] - at_[v]);
    std::sort(directions.begin(), directions.begin() + std::ptrdiff_t(degree));
    double from = directions[degree - 1], widest = turn(from, directions[0]);
    if (degree == 1) widest = 2 * M_PI;
    for (std::size_t j = 0; j + 1 < degree; ++j)
      if (const double gap = directions[j + 1] - directions[j]; gap > widest) {
        widest = gap;
        from = directions[j];
      }
    if (widest <= radians(degree <= 2 ? options_.gap_sparse : options_.gap)) return kNone;
    const double clearance = radians(options_.gap_clearance);
    const Sector inside(from + clearance, widest - 2 * clearance);
    for (const Index q : terrain_.near[v])
      if (inside.holds(plane.project(at_[q] - at_[v])) && admissible(v, q, options_.lune)) return q;
    return kNone;
  }

  bool short_enough_alone(Index v, Index q) const {
    return (at_[q] - at_[v]).norm() <= options_.lone_reach * std::min(reach(v), reach(q));
  }

  /// (C)
  bool is_bridge(Index a, Index b) const {
    if (terrain_.is_between(a) || terrain_.is_between(b)) return true;
    const Vector3d d = at_[b] - at_[a];
    if (d.norm() > options_.bridge * std::max(reach(a), reach(b))) return true;
    return steep(a, d, options_.bridge_steepness) && steep(b, d, options_.bridge_steepness);
  }

 private:
  const Vector3d& normal(Index v) const { return terrain_.surfaces[v].normal; }
  double reach(Index v) const { return std::max(length_[v], terrain_.noise); }

  /// Whether d rises more than `most` over its run along the surface at v, beyond what noise explains.
  bool steep(Index v, const Vector3d& d, double most) const {
    const double rise = std::abs(normal(v).dot(d)), over = rise - terrain_.noise;
    const double squared_run = std::max(0.0, d.squaredNorm() - rise * rise);
    return over > 0 && over * over > most * most * squared_run;
  }

  bool admissible(Index v, Index q, double lune) const {
    const Vector3d d = at_[q] - at_[v];
    const double length = d.norm();
    return !terrain_.is_between(q) && length <= options_.reach * std::max(reach(v), reach(q)) &&
           std::abs(normal(v).dot(normal(q))) >= cos_normal_ && !steep(v, d, options_.steepness) &&
           !steep(q, d, options_.steepness) && !within_two_hops(v, q) && !needless(v, q, lune * length);
  }

  bool within_two_hops(Index v, Index q) const {
    for (const Index a : graph_[v]) {
      if (a == q || std::binary_search(graph_[a].begin(), graph_[a].end(), q)) return true;
    }
    return false;
  }

  /// Whether some z lies nearer than `radius` to both v and q. v's list is nearest first, so it holds every
  /// such z if it holds q.
  bool needless(Index v, Index q, double radius) const {
    const double most = radius * radius;
    for (const Index z : terrain_.near[v]) {
      if (!((at_[z] - at_[v]).squaredNorm() < most)) return false;
      if ((at_[z] - at_[q]).squaredNorm() < most) return true;
    }
    return false;
  }

  const Terrain& terrain_;
  const Positions& at_;
  const std::vector<double>& length_;
  const Adjacency& graph_;
  const SdgOptions& options_;
  double cos_normal_;
};

/// The edges that the wishes make: wish[v] = q counts if `granted(v, q)`; each edge once.
template <class Granted>
std::vector<Edge> granted_edges(const std::vector<Index>& wish, const Context& context, Granted&& granted) {
  return collect<Edge>(context, wish.size(), [&](std::size_t i, auto&& emit) {
    const Index v = Index(i), q = wish[v];
    if (q == kNone || !granted(v, q)) return;
    if (wish[q] == v && q < v) return;  // q emits it
    emit({std::min(v, q), std::max(v, q)});
  });
}

template <class Wish>
std::vector<Index> wishes(std::size_t n, const Context& context, Wish&& wish) {
  std::vector<Index> all(n);
  for_each_index(
      context, n, [&](std::size_t v) { all[v] = wish(Index(v)); }, 256);
  return all;
}

void append(std::vector<Edge>& edges, const std::vector<Edge>& more) {
  edges.insert(edges.end(), more.begin(), more.end());
}

std::vector<Edge> extend_leaves(const Rules& rules, std::size_t n, const Context& context) {
  const auto wish = wishes(n, context, [&](Index v) { return rules.beyond_leaf(v); });
  return granted_edges(wish, context, [](Index, Index) { return true; });
}

std::vector<Edge> fill_gaps(const Rules& rules, std::size_t n, const Context& context) {
  const auto wish = wishes(n, context, [&](Index v) { return rules.across_gap(v); });
  return granted_edges(wish, context,
                       [&](Index v, Index q) { return wish[q] == v || rules.short_enough_alone(v, q); });
}

std::vector<Edge> pick(const std::vector<Edge>& edges, const Context& context, const std::vector<char>& flag,
                       char wanted) {
  return collect<Edge>(context, edges.size(), [&](std::size_t e, auto&& emit) {
    if (flag[e] == wanted) emit(edges[e]);
  });
}

}  // namespace

Sdg make_sdg(const Terrain& terrain, const std::vector<Edge>& tree, const SdgOptions& options,
             const Context& context) {
  const std::size_t n = terrain.at.size();
  Sdg sdg;
  Adjacency graph = make_adjacency(n, tree, context);
  sdg.local_length.resize(n);
  for_each_index(context, n,
                 [&](std::size_t v) { sdg.local_length[v] = local_length(terrain.at, graph, Index(v)); });
  const Rules rules(terrain, sdg.local_length, graph, options);

  std::vector<char> bridge(tree.size());
  for_each_index(context, tree.size(),
                 [&](std::size_t e) { bridge[e] = rules.is_bridge(tree[e][0], tree[e][1]); });
  sdg.edges = pick(tree, context, bridge, 0);
  sdg.bridges = pick(tree, context, bridge, 1);
  parallel_sort(context, sdg.bridges, std::less<Edge>());

  graph = make_adjacency(n, sdg.edges, context);
  append(sdg.edges, extend_leaves(rules, n, context));
  constexpr int kGapRounds = 2;  // the second sees what the first has closed; a third adds under 1 %
  for (int round = 0; round < kGapRounds; ++round) {
    graph = make_adjacency(n, sdg.edges, context);
    append(sdg.edges, fill_gaps(rules, n, context));
  }
  parallel_sort(context, sdg.edges, std::less<Edge>());
  return sdg;
}

}  // namespace rfsmooth::rfs_mesh
