#include "rfsmooth/rfs_mesh/emst.h"

#include <atomic>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

constexpr int kSeeds = 6;  // nearest neighbours listed per point when the caller has no table
constexpr std::uint64_t kNothing = std::numeric_limits<std::uint64_t>::max();

/// Non-negative doubles order like their bits: lets lengths be minimised by an atomic of integers.
std::uint64_t to_bits(double d2) {
  std::uint64_t bits;
  std::memcpy(&bits, &d2, sizeof bits);
  return bits;
}
double to_length(std::uint64_t bits) {
  if (bits == kNothing) return std::numeric_limits<double>::infinity();
  double d2;
  std::memcpy(&d2, &bits, sizeof d2);
  return d2;
}

/// Lowers `target` to `value`: whatever the order of the calls, the least value remains.
void lower(std::atomic<std::uint64_t>& target, std::uint64_t value) {
  std::uint64_t seen = target.load(std::memory_order_relaxed);
  while (value < seen && !target.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
}

std::uint64_t pair_of(Index a, Index b) {
  return a < b ? std::uint64_t(a) << 32 | b : std::uint64_t(b) << 32 | a;
}

class Boruvka {
 public:
  Boruvka(const SpatialIndex& index, const NeighborTable& nearest, const Context& context)
      : points_(index.points()),
        tree_(index.tree()),
        nearest_(nearest),
        context_(context),
        n_(points_.size()),
        component_(n_),
        next_(n_, 0),
        candidate_(n_, kNone),
        reach_(n_),
        best_length_(n_),
        best_pair_(n_),
        joined_(n_),
        leaf_component_(tree_.leaf_count()),
        node_component_(tree_.node_count()) {
    roots_.resize(n_);
    for_each_index(context_, n_, [&](std::size_t i) {
      component_[i] = roots_[i] = Index(i);
      reach_[i] = squared_distance(points_[i], points_[nearest_[i][nearest_.k - 1]]);
    });
    edges_.reserve(n_ - 1);
  }

  std::vector<Edge> run() {
    while (roots_.size() > 1) {
      for_each_index(context_, roots_.size(), [&](std::size_t r) {
        best_length_[roots_[r]].store(kNothing, std::memory_order_relaxed);
        best_pair_[roots_[r]].store(kNothing, std::memory_order_relaxed);
      });
      look_along_lists();
      label_nodes();
      search_tree();
      choose();
      join();
    }
    sort_edges();
    return std::move(edges_);
  }

 private:
  double length(Index a, Index b) const { return squared_distance(points_[a], points_[b]); }

  /// Every point offers its nearest listed neighbour in another component.
  void look_along_lists() {
    for_each_index(context_, n_, [&](std::size_t i) {
      const Index own = component_[i];
      const auto row = nearest_[i];
      std::uint32_t at = next_[i];
      while (at < row.size() && component_[row[at]] == own) ++at;
      next_[i] = at;
      if (at < row.size()) {
        candidate_[i] = row[at];
      } else if (candidate_[i] != kNone && component_[candidate_[i]] == own) {
        candidate_[i] = kNone;
      }
      if (candidate_[i] != kNone) lower(best_length_[own], to_bits(length(Index(i), candidate_[i])));
    });
  }

  /// The component of each node of the tree whose points all share one, else kNone.
  void label_nodes() {
    for_each_index(context_, tree_.leaf_count(), [&](std::size_t l) {
      const KdTree::Leaf& leaf = tree_.leaf(std::uint32_t(l));
      Index shared = component_[leaf.id[0]];
      for (std::uint32_t i = 1; i < KdTree::kLeaf && leaf.id[i] != kNone; ++i)
        if (component_[leaf.id[i]] != shared) shared = kNone;
      leaf_component_[l] = shared;
    });
    label(tree_.root());
  }
  Index label(const KdTree::Cursor& c) {
    if (c.is_leaf()) return node_component_[c.node] = leaf_component_[c.first];
    const Index left = label(c.left()), right = label(c.right());
    return node_component_[c.node] = left == right ? left : kNone;
  }

  /// Points whose list is used up search the tree, if something shorter than their component's best may be
  /// there.
  void search_tree() {
    for_each_index(
        context_, n_,
        [&](std::size_t i) {
          if (candidate_[i] != kNone) return;
          const Index own = component_[i];
          const double bound = to_length(best_length_[own].load(std::memory_order_relaxed));
          if (reach_[i] > bound) return;
          const Neighbor found = nearest_foreign(Index(i), own, bound);
          candidate_[i] = found.index;
          reach_[i] = found.squared_distance;
          if (found.index != kNone) lower(best_length_[own], to_bits(found.squared_distance));
        },
        128);
  }

  /// The nearest point of another component at most sqrt(bound) away, or {kNone, bound}.
  Neighbor nearest_foreign(Index self, Index own, double bound) const {
    const Vector3d q = points_[self];
    Neighbor best = {kNone, bound};
    struct Pending {
      KdTree::Cursor cursor;
      double squared_distance;
    } stack[64];
    std::size_t top = 0;
    stack[top++] = {tree_.root(), 0};
    while (top > 0) {
      Pending at = stack[--top];
      for (;;) {
        if (best < Neighbor{tree_.node(at.cursor.node).least_id, at.squared_distance}) break;
        if (node_component_[at.cursor.node] == own) break;
        if (at.cursor.is_leaf()) {
          const KdTree::Leaf& leaf = tree_.leaf(at.cursor.first);
          for (std::uint32_t i = 0; i < KdTree::kLeaf && leaf.id[i] != kNone; ++i)
            if (component_[leaf.id[i]] != own) {
              const Neighbor candidate = {leaf.id[i], length(self, leaf.id[i])};
              if (candidate < best) best = candidate;
            }
          break;
        }
        Pending near = {at.cursor.left(), 0}, far = {at.cursor.right(), 0};
        near.squared_distance = tree_.squared_distance(q, near.cursor.node);
        far.squared_distance = tree_.squared_distance(q, far.cursor.node);
        if (far.squared_distance < near.squared_distance) std::swap(near, far);
        stack[top++] = far;
        at = near;
      }
    }
    return best;
  }

  /// Among a component's edges of the least length, the one of least ids.
  void choose() {
    for_each_index(context_, n_, [&](std::size_t i) {
      if (candidate_[i] == kNone) return;
      const Index own = component_[i];
      if (to_bits(length(Index(i), candidate_[i])) == best_length_[own].load(std::memory_order_relaxed))
        lower(best_pair_[own], pair_of(Index(i), candidate_[i]));
    });
  }

  /// Joins every component with the one its best edge leads to. Two that chose the same edge: the smaller
  /// stays.
  void join() {
    for (const Index root : roots_) {
      const std::uint64_t pair = best_pair_[root].load(std::memory_order_relaxed);
      if (pair == kNothing) throw std::logic_error("EMST: a component without an edge");
      const Index a = Index(pair >> 32), b = Index(pair);
      const Index other = component_[a] == root ? component_[b] : component_[a];
      const bool mutual = best_pair_[other].load(std::memory_order_relaxed) == pair;
      joined_[root] = mutual && root < other ? root : other;
      if (!mutual || root < other) edges_.push_back({a, b});
    }
    // Pointer doubling: chains may be as long as the cloud.
    std::vector<Index> jumped(roots_.size());
    for (bool changed = true; changed;) {
      changed = reduce_blocks(
                    context_, roots_.size(), 0,
                    [&](std::size_t begin, std::size_t end) {
                      int any = 0;
                      for (std::size_t r = begin; r < end; ++r) {
                        jumped[r] = joined_[joined_[roots_[r]]];
                        any |= int(jumped[r] != joined_[roots_[r]]);
                      }
                      return any;
                    },
                    [](int a, int b) { return a | b; }) != 0;
      for_each_index(context_, roots_.size(), [&](std::size_t r) { joined_[roots_[r]] = jumped[r]; });
    }
    for_each_index(context_, n_, [&](std::size_t i) { component_[i] = joined_[component_[i]]; });
    roots_.erase(std::remove_if(roots_.begin(), roots_.end(), [&](Index r) { return joined_[r] != r; }),
                 roots_.end());
  }

  void sort_edges() {
    struct Keyed {
      double squared_length;
      Edge edge;
    };
    std::vector<Keyed> keyed(edges_.size());
    for_each_index(context_, edges_.size(), [&](std::size_t e) {
      keyed[e] = {length(edges_[e][0], edges_[e][1]), edges_[e]};
    });
    parallel_sort(context_, keyed, [](const Keyed& a, const Keyed& b) {
      return a.squared_length != b.squared_length ? a.squared_length < b.squared_length : a.edge < b.edge;
    });
    for_each_index(context_, edges_.size(), [&](std::size_t e) { edges_[e] = keyed[e].edge; });
  }

  const Positions& points_;
  const KdTree& tree_;
  const NeighborTable& nearest_;
  const Context& context_;
  std::size_t n_;
  std::vector<Index> component_;                         // of a point: a root
  std::vector<std::uint32_t> next_;                      // of a point: place in its list
  std::vector<Index> candidate_;                         // of a point: its nearest known point elsewhere
  std::vector<double> reach_;                            // of a point: nothing foreign and unlisted is nearer
  std::vector<std::atomic<std::uint64_t>> best_length_;  // of a root
  std::vector<std::atomic<std::uint64_t>> best_pair_;    // of a root
  std::vector<Index> joined_;                            // of a root: the root it joins
  std::vector<Index> leaf_component_, node_component_;
  std::vector<Index> roots_;
  std::vector<Edge> edges_;
};

}  // namespace

std::vector<Edge> emst(const SpatialIndex& index, const NeighborTable& nearest, const Context& context) {
  if (index.points().size() < 2) return {};
  if (nearest.size() != index.points().size())
    throw std::invalid_argument("emst: the table is not of these points");
  return Boruvka(index, nearest, context).run();
}

std::vector<Edge> emst(const SpatialIndex& index, const Context& context) {
  return emst(index, index.nearest(kSeeds, context), context);
}

}  // namespace rfsmooth::rfs_mesh
