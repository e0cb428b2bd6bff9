#include "rfs_mesh/connect/emst/emst.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>

#include "base/collect.h"
#include "base/parallel.h"
#include "rfs_mesh/connect/ordered_bits.h"
#include "rfs_mesh/search/foreign_search.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Cursor = KdTree::Cursor;

constexpr int kLongestList = 255;  // places beyond are not looked at: they fit a byte

constexpr std::uint32_t kWorthAsking = 8;  // leaves of the nodes that are first asked about as a whole

constexpr std::uint64_t kNothing = std::numeric_limits<std::uint64_t>::max();

/// The squared length of these ordered_bits, of which an atomic integer keeps the least; infinite if none.
double to_length(std::uint64_t bits) {
  if (bits == kNothing) return std::numeric_limits<double>::infinity();
  double d2 = 0;
  std::memcpy(&d2, &bits, sizeof d2);
  return d2;
}

void lower(std::atomic<std::uint64_t>& least, std::uint64_t value) {
  keep_first(least, value, std::less<>());
}

std::uint64_t pair_of(Index a, Index b) {
  return a < b ? std::uint64_t(a) << 32 | b : std::uint64_t(b) << 32 | a;
}

/// Boruvka's rounds. A component is named by one of its points, its root.
class Boruvka {
 public:
  Boruvka(const SpatialIndex& index, const NeighborTable& lists, const Context& context)
      : points_(index.points()),
        tree_(index.tree()),
        lists_(lists),
        context_(context),
        n_(points_.size()),
        component_(n_),
        next_(n_, 0),
        candidate_(n_),
        reach_(n_),
        best_length_(n_),
        best_pair_(n_),
        foreign_(index, component_),
        node_reach_(tree_.node_count(), -1),
        roots_(n_) {
    for_each_index(context_, n_, [&](std::size_t i) {
      component_[i] = roots_[i] = Index(i);
      candidate_[i] = lists_[i][0];
      reach_[i] = length(Index(i), candidate_[i]);
    });
  }

  /// The edges, in no order worth knowing.
  std::vector<Edge> run() {
    choose_nearest();
    join();
    while (roots_.size() > 1) {
      for_each_index(context_, roots_.size(), [&](std::size_t r) {
        best_length_[roots_[r]].store(kNothing, std::memory_order_relaxed);
        best_pair_[roots_[r]].store(kNothing, std::memory_order_relaxed);
      });
      look_along_lists();
      search_tree();
      choose();
      join();
    }
    return edges();
  }

 private:
  double length(Index a, Index b) const { return squared_distance(points_[a], points_[b]); }
  double best_of(Index root) const { return to_length(best_length_[root].load(std::memory_order_relaxed)); }

  /// The first round: every point is a component, and its nearest is known.
  void choose_nearest() {
    for_each_index(context_, n_, [&](std::size_t i) {
      best_length_[i].store(ordered_bits(reach_[i]), std::memory_order_relaxed);
      best_pair_[i].store(pair_of(Index(i), candidate_[i]), std::memory_order_relaxed);
    });
  }

  /// Every point offers its nearest known point in another component.
  void look_along_lists() {
    const std::uint32_t k = std::uint32_t(std::min(lists_.k, kLongestList));
    for_each_index(context_, n_, [&](std::size_t i) {
      if (candidate_[i] == kNone) return;
      const Index own = component_[i];
      if (component_[candidate_[i]] == own) {
        candidate_[i] = kNone;
        if (next_[i] == k) return;  // had been searched for: reach_ stays true
        const auto list = lists_[i];
        std::uint32_t at = next_[i] + 1;
        while (at < k && component_[list[at]] == own) ++at;
        next_[i] = std::uint8_t(at);
        if (at < k) candidate_[i] = list[at];
        reach_[i] = length(Index(i), list[std::min(at, k - 1)]);
        if (at == k) return;
      }
      lower(best_length_[own], ordered_bits(reach_[i]));
    });
  }

  /// Points whose list is used up search the tree, where something shorter than their component's best may
  /// be.
  void search_tree() {
    foreign_.label(context_);
    for_each_index(
        context_, foreign_.subtrees().size(), [&](std::size_t s) { search(foreign_.subtrees()[s]); }, 1);
  }

  /// The points of one node. A node inside a component is passed over as a whole if nothing foreign is as
  /// near to its box as the component's best; that stays true in later rounds, since what is foreign only
  /// shrinks.
  void search(const Cursor& c) {
    if (c.is_leaf()) return search_leaf(c);
    const Index own = foreign_.shared(c);
    if (own != kNone && c.last - c.first >= kWorthAsking) {
      const double bound = best_of(own);
      if (node_reach_[c.node] > bound) return;
      if (!foreign_.any_within(c, own, bound)) {
        node_reach_[c.node] = bound;
        return;
      }
    }
    search(c.left());
    search(c.right());
  }

  bool must_search(Index i) const {
    return i != kNone && candidate_[i] == kNone && reach_[i] <= best_of(component_[i]);
  }

  /// The points of a leaf inside a component share the walk to the foreign leaves near it.
  void search_leaf(const Cursor& c) {
    const KdTree::Leaf& leaf = tree_.leaf(c.first);
    const Index own = foreign_.shared(c);
    bool listed = false;
    ForeignSearch::Leaves near;
    for (const Index i : leaf.id) {
      if (!must_search(i)) continue;
      const double bound = best_of(component_[i]);
      if (!listed && own != kNone) listed = foreign_.list(c, own, bound, near);
      const Neighbor found =
          listed ? foreign_.nearest_in(near, i, own, bound) : foreign_.nearest(i, component_[i], bound);
      candidate_[i] = found.index;
      reach_[i] = found.squared_distance;
      if (found.index != kNone) lower(best_length_[component_[i]], ordered_bits(found.squared_distance));
    }
  }

  /// Among a component's edges of the least length, the one of least ids.
  void choose() {
    for_each_index(context_, n_, [&](std::size_t i) {
      if (candidate_[i] == kNone) return;
      const Index own = component_[i];
      if (ordered_bits(reach_[i]) == best_length_[own].load(std::memory_order_relaxed))
        lower(best_pair_[own], pair_of(Index(i), candidate_[i]));
    });
  }

  /// Joins every component with the one its best edge leads to. Of two that chose the same edge the one of
  /// the smaller root stays: there are no other cycles, since edges are totally ordered.
  void join() {
    const auto best_pair = [&](Index root) { return best_pair_[root].load(std::memory_order_relaxed); };
    for_each_index(context_, roots_.size(), [&](std::size_t r) {
      const Index root = roots_[r];
      const std::uint64_t pair = best_pair(root);
      if (pair == kNothing) throw std::logic_error("EMST: a component without an edge");
      const Index a = Index(pair >> 32), b = Index(pair);
      const Index other = component_[a] == root ? component_[b] : component_[a];
      next_root_[root].store(best_pair(other) == pair && root < other ? root : other,
                             std::memory_order_relaxed);
    });
    std::vector<Index> staying = staying_roots();
    follow_joins();
    for_each_index(context_, n_, [&](std::size_t i) { component_[i] = joined(component_[i]); });
    roots_.swap(staying);
  }

  /// The root that a root joins: itself if it stays.
  Index joined(Index root) const { return Index(next_root_[root].load(std::memory_order_relaxed)); }

  std::vector<Index> staying_roots() const {
    return collect<Index>(context_, roots_.size(), [&](std::size_t r, auto&& emit) {
      if (joined(roots_[r]) == roots_[r]) emit(roots_[r]);
    });
  }

  /// Makes joined() name the root that stays. By doubling: chains may be as long as the cloud. A step reads
  /// the lower halves and writes its result into the upper ones, which the next loop moves down.
  void follow_joins() {
    for (bool changed = true; changed;) {
      changed =
          reduce_blocks(
              context_, roots_.size(), 0,
              [&](std::size_t begin, std::size_t end) {
                int any = 0;
                for (std::size_t r = begin; r < end; ++r) {
                  const Index from = joined(roots_[r]), to = joined(from);
                  any |= int(to != from);
                  next_root_[roots_[r]].store(std::uint64_t(to) << 32 | from, std::memory_order_relaxed);
                }
                return any;
              },
              [](int a, int b) { return a | b; }) != 0;
      for_each_index(context_, roots_.size(), [&](std::size_t r) {
        auto& root = next_root_[roots_[r]];
        root.store(root.load(std::memory_order_relaxed) >> 32, std::memory_order_relaxed);
      });
    }
  }

  /// The edges that joined the roots: a root that has joined another is none any more, and keeps its pair.
  std::vector<Edge> edges() {
    std::vector<double>().swap(reach_);  // room for the result
    std::vector<Edge> edges(n_ - 1);
    const Index last = roots_.front();
    for_each_index(context_, n_, [&](std::size_t i) {
      if (i == last) return;
      const std::uint64_t pair = best_pair_[i].load(std::memory_order_relaxed);
      edges[i < last ? i : i - 1] = {Index(pair >> 32), Index(pair)};
    });
    return edges;
  }

  const Positions& points_;
  const KdTree& tree_;
  const NeighborTable& lists_;
  const Context& context_;
  std::size_t n_;

  // of a point
  std::vector<Index> component_;
  std::vector<std::uint8_t> next_;  // place of the candidate in its list, k if the list is used up
  std::vector<Index> candidate_;    // its nearest point in another component, kNone if not known
  std::vector<double> reach_;  // squared: how far the candidate is; without one, nothing foreign is nearer

  // of a root
  std::vector<std::atomic<std::uint64_t>> best_length_, best_pair_;
  std::vector<std::atomic<std::uint64_t>>& next_root_ = best_length_;  // once the edge is chosen

  ForeignSearch foreign_;
  std::vector<double> node_reach_;  // of a node of the tree, squared: nothing foreign is nearer to its box

  std::vector<Index> roots_;
};

void sort_by_length(std::vector<Edge>& edges, const Positions& points, const Context& context) {
  struct Keyed {
    double squared_length;
    Edge edge;
  };
  std::vector<Keyed> keyed(edges.size());
  for_each_index(context, edges.size(), [&](std::size_t e) {
    keyed[e] = {squared_distance(points[edges[e][0]], points[edges[e][1]]), edges[e]};
  });
  parallel_sort(context, keyed, [](const Keyed& a, const Keyed& b) {
    return a.squared_length != b.squared_length ? a.squared_length < b.squared_length : a.edge < b.edge;
  });
  for_each_index(context, edges.size(), [&](std::size_t e) { edges[e] = keyed[e].edge; });
}

}  // namespace

std::vector<Edge> emst_unsorted(const SpatialIndex& index, const NeighborTable& near,
                                const Context& context) {
  if (index.points().size() < 2) return {};
  if (near.size() != index.points().size())
    throw std::invalid_argument("emst: the table is not of these points");
  return Boruvka(index, near, context).run();
}

std::vector<Edge> emst(const SpatialIndex& index, const NeighborTable& near, const Context& context) {
  std::vector<Edge> edges = emst_unsorted(index, near, context);
  sort_by_length(edges, index.points(), context);
  return edges;
}

}  // namespace rfsmooth::rfs_mesh
