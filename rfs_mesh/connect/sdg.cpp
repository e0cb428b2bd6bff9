#include "rfs_mesh/connect/sdg.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "base/avx2.h"
#include "base/collect.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/corners.h"
#include "rfs_mesh/fit/tangent_plane.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kMostDirections = 32;  ///< vertices of higher degree have no gap worth closing

/// The median length of the EMST edges within two hops of v: the edges of v, its neighbours and theirs; of
/// the first of them where there are more than fit (coincident points are joined to one of them). \param
/// squares their squared lengths, item for item of `tree`
RFSMOOTH_AVX2
double local_length(const std::vector<float>& squares, const Adjacency& tree, Index v) {
  constexpr std::size_t kMost = 64;
  std::array<float, kMost> around;
  std::size_t count = 0;
  const auto add = [&](Index from, Index not_to) {
    for (Index k = tree.start[from]; k < tree.start[from + 1] && count < kMost; ++k)
      if (tree.items[k] != not_to) around[count++] = squares[k];
  };
  add(v, kNone);
  for (const Index a : tree[v]) {
    add(a, v);
    for (const Index b : tree[a]) {
      if (count == kMost) break;
      if (b != v) add(b, a);
    }
    if (count == kMost) break;
  }
  return count > 0 ? std::sqrt(double(nth_of_few(around, count, count / 2))) : 0;
}

std::vector<double> local_lengths(const Positions& at, const Adjacency& tree, const Context& context) {
  std::vector<float> squares(tree.items.size());
  for_each_index(context, at.size(), [&](std::size_t v) {
    for (Index k = tree.start[v]; k < tree.start[v + 1]; ++k)
      squares[k] = float((at[tree.items[k]] - at[v]).squaredNorm());
  });
  std::vector<double> lengths(at.size());
  for_each_index(context, at.size(),
                 [&](std::size_t v) { lengths[v] = local_length(squares, tree, Index(v)); });
  return lengths;
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
        cos_normal_(std::cos(radians(options.normal_angle))),
        clearance_(Eigen::Rotation2Dd(radians(options.gap_clearance)).toRotationMatrix()) {}

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
    std::array<Spoke, kMostDirections> spokes;
    for (std::size_t j = 0; j < degree; ++j) spokes[j] = Spoke(plane.project(at_[graph_[v][j]] - at_[v]));
    std::sort(spokes.begin(), spokes.begin() + std::ptrdiff_t(degree),
              [](const Spoke& x, const Spoke& y) { return x.angle < y.angle; });
    std::size_t from = degree - 1, to = 0;
    double widest = degree == 1 ? 2 * M_PI : turn(spokes[from].angle, spokes[to].angle);
    for (std::size_t j = 0; j + 1 < degree; ++j)
      if (const double gap = spokes[j + 1].angle - spokes[j].angle; gap > widest) {
        widest = gap;
        from = j;
        to = j + 1;
      }
    if (widest <= radians(degree <= 2 ? options_.gap_sparse : options_.gap)) return kNone;
    const Sector inside(clearance_ * spokes[from].along, clearance_.transpose() * spokes[to].along,
                        widest - 2 * radians(options_.gap_clearance));
    for (const Index q : terrain_.near[v])
      if (inside.holds(plane.project(at_[q] - at_[v])) && admissible(v, q, options_.lune)) return q;
    return kNone;
  }

  /// The same for who wanted to reach `last` while the graph was a part of what it is now and v had the same
  /// neighbours: what was not admissible then is not now.
  Index across_gap_still(Index v, Index last) const {
    return last == kNone || !within_two_hops(v, last) ? last : across_gap(v);
  }

  bool short_enough_alone(Index v, Index q) const {
    return (at_[q] - at_[v]).norm() <= options_.lone_reach * std::min(reach(v), reach(q));
  }

  /// (C)
  bool is_bridge(Index a, Index b) const {
    if (terrain_.is_between(a) || terrain_.is_between(b)) return true;
    const Vector3d d = at_[b] - at_[a];
    if (d.norm() > options_.bridge * std::max(reach(a), reach(b))) return true;
    const double most = options_.bridge_steepness;
    return terrain_.is_steep(a, d, most) && terrain_.is_steep(b, d, most);
  }

 private:
  /// An edge's direction in the tangent plane.
  struct Spoke {
    Eigen::Vector2d along;  ///< not of unit length
    double angle;
    Spoke() = default;
    explicit Spoke(const Eigen::Vector2d& d)
        : along(d.isZero(0) ? Eigen::Vector2d(Eigen::Vector2d::UnitX()) : d), angle(direction(d[0], d[1])) {}
  };

  const Vector3d& normal(Index v) const { return terrain_.surfaces[v].normal; }
  double reach(Index v) const { return std::max(length_[v], terrain_.noise); }

  bool admissible(Index v, Index q, double lune) const {
    const Vector3d d = at_[q] - at_[v];
    const double length = d.norm();
    return !terrain_.is_between(q) && length <= options_.reach * std::max(reach(v), reach(q)) &&
           terrain_.is_along(v, q, d, cos_normal_, options_.steepness) && !within_two_hops(v, q) &&
           !needless(v, q, lune * length);
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
  Eigen::Matrix2d clearance_;  ///< turns counter-clockwise by it
};

/// The edges that the wishes make: wish[v] = q counts if `granted(v, q)`; each edge once.
template <class Granted>
std::vector<Edge> granted_edges(const std::vector<Index>& wish, const Context& context, Granted&& granted) {
  return collect<Edge>(context, wish.size(), [&](std::size_t i, auto&& emit) {
    const Index v = Index(i), q = wish[v];
    if (q == kNone || !granted(v, q)) return;
    if (wish[q] == v && q < v) return;  // q emits it
    emit(edge_between(v, q));
  });
}

template <class Wish>
std::vector<Index> wishes(std::size_t n, const Context& context, Wish&& wish) {
  std::vector<Index> all(n);
  for_each_index(
      context, n, [&](std::size_t v) { all[v] = wish(Index(v)); }, 256);
  return all;
}

std::vector<Edge> extend_leaves(const Rules& rules, std::size_t n, const Context& context) {
  const auto wish = wishes(n, context, [&](Index v) { return rules.beyond_leaf(v); });
  return granted_edges(wish, context, [](Index, Index) { return true; });
}

/// Adds edges to the graph across gaps, in two rounds.
void fill_gaps(const Rules& rules, Adjacency& graph, const Context& context) {
  const std::size_t n = graph.size();
  constexpr int kFillings = 2;  // the second sees what the first has closed; a third adds under 1 %
  std::vector<Index> wish;
  std::vector<char> changed(n, 1);
  for (int round = 0; round < kFillings; ++round) {
    wish = wishes(n, context, [&](Index v) {
      return changed[v] != 0 ? rules.across_gap(v) : rules.across_gap_still(v, wish[v]);
    });
    const std::vector<Edge> edges = granted_edges(
        wish, context, [&](Index v, Index q) { return wish[q] == v || rules.short_enough_alone(v, q); });
    std::fill(changed.begin(), changed.end(), 0);
    for (const Edge& e : edges) changed[e[0]] = changed[e[1]] = 1;
    graph = joined(graph, make_adjacency(n, edges, context), context);
  }
}

std::vector<Edge> flagged(const std::vector<Edge>& edges, const Context& context,
                          const std::vector<char>& flag, char wanted) {
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
  sdg.local_length = local_lengths(terrain.at, graph, context);
  const Rules rules(terrain, sdg.local_length, graph, options);

  std::vector<char> bridge(tree.size());
  for_each_index(context, tree.size(),
                 [&](std::size_t e) { bridge[e] = rules.is_bridge(tree[e][0], tree[e][1]); });
  sdg.bridges = flagged(tree, context, bridge, 1);
  parallel_sort(context, sdg.bridges, std::less<Edge>());
  if (!sdg.bridges.empty()) graph = make_adjacency(n, flagged(tree, context, bridge, 0), context);

  graph = joined(graph, make_adjacency(n, extend_leaves(rules, n, context), context), context);
  fill_gaps(rules, graph, context);
  sdg.edges = edges_of(graph, context);
  sdg.graph = std::move(graph);
  return sdg;
}

}  // namespace rfsmooth::rfs_mesh
