#include "rfs_mesh/search/thinning.h"

#include <algorithm>
#include <atomic>

#include "base/collect.h"
#include "base/parallel.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

enum class Fate : unsigned char { open, kept, dropped };

/// Marks that several threads set, none takes back.
using Marks = std::vector<std::atomic<char>>;
void mark(std::atomic<char>& at) {
  at.store(1, std::memory_order_relaxed);
}

/// The thinning of points by the first k of their neighbours. An edge of the graph is seen from one end only,
/// so each end may tell the other.
class Thinning {
 public:
  Thinning(const Positions& at, const NeighborTable& near, std::size_t k, const Context& context)
      : near_(near),
        k_(std::min(k, std::size_t(near.k))),
        context_(context),
        priority_(at.size()),
        state_(at.size(), Fate::open),
        blocked_(at.size()),
        covered_(at.size()),
        open_(at.size()) {
    for_each_index(context, at.size(), [&](std::size_t s) {
      // A sum, since two points that are each other's k-th neighbours would tie.
      double sum = 0;
      for (const Index t : row(s)) sum += (at[t] - at[s]).squaredNorm();
      priority_[s] = sum;
      open_[s] = Index(s);
    });
  }

  std::vector<Index> run() {
    for (; !open_.empty(); ++rounds_) {
      // Open ones before all their open neighbours are kept, then the neighbours of kept ones are dropped.
      for_open([&](Index s) {
        for (const Index t : row(s))
          if (state_[t] == Fate::open) mark(blocked_[before(t, s) ? s : t]);
      });
      for_open([&](Index s) {
        if (blocked_[s] == 0) state_[s] = Fate::kept;
      });
      for_open([&](Index s) {
        for (const Index t : row(s)) {
          if (state_[s] == Fate::kept) mark(covered_[t]);
          if (state_[t] == Fate::kept) mark(covered_[s]);
        }
      });
      for_open([&](Index s) {
        blocked_[s].store(0, std::memory_order_relaxed);
        if (state_[s] == Fate::open && covered_[s] != 0) state_[s] = Fate::dropped;
      });
      const std::vector<Index> all = std::move(open_);
      open_ = rfsmooth::collect<Index>(context_, all.size(), [&](std::size_t i, auto&& emit) {
        if (state_[all[i]] == Fate::open) emit(all[i]);
      });
    }
    return rfsmooth::collect<Index>(context_, state_.size(), [&](std::size_t s, auto&& emit) {
      if (state_[s] == Fate::kept) emit(Index(s));
    });
  }

 private:
  Adjacency::Row row(std::size_t s) const {
    const Index* const first = near_[s].begin();
    return {first, first + k_};
  }
  /// Priorities that rise from point to point, as on a regular grid where they tie, settle one point of a row
  /// in each round. After many rounds the order of what is left is mixed.
  bool before(Index a, Index b) const {
    constexpr std::size_t kMany = 64;
    if (rounds_ >= kMany) return mixed(a) < mixed(b);
    return priority_[a] != priority_[b] ? priority_[a] > priority_[b] : a < b;
  }
  /// Another number for each, by Fibonacci hashing (Knuth 1973, section 6.4).
  static Index mixed(Index i) { return i * 2654435769U; }
  template <class Body>
  void for_open(const Body& body) {
    for_each_index(context_, open_.size(), [&](std::size_t i) { body(open_[i]); });
  }

  const NeighborTable& near_;
  std::size_t k_;
  const Context& context_;
  std::vector<double> priority_;
  std::vector<Fate> state_;
  Marks blocked_, covered_;
  std::vector<Index> open_;
  std::size_t rounds_ = 0;
};

/// Those of a set with fewer than four points: one, if there is any.
std::vector<Index> first_of(const std::vector<Index>& subset) {
  return {subset.begin(), subset.begin() + std::ptrdiff_t(std::min<std::size_t>(subset.size(), 1))};
}

std::vector<Index> named(std::vector<Index> kept, const std::vector<Index>& subset) {
  for (Index& k : kept) k = subset[k];
  return kept;
}

}  // namespace

std::vector<Index> thin(const Positions& points, const std::vector<Index>& subset, const Context& context) {
  if (subset.size() <= kThinNear) return first_of(subset);
  const Positions at = at_rows(points, subset, context);
  const NeighborTable near = SpatialIndex(at, context).nearest(int(kThinNear), context);
  return named(Thinning(at, near, kThinNear, context).run(), subset);
}

std::vector<Index> thin_all(const Positions& points, const NeighborTable& near, const Context& context,
                            std::size_t k) {
  return Thinning(points, near, k, context).run();
}

std::vector<Index> thin_dense(const SpatialIndex& index, std::size_t width,
                              const std::function<void(Index i, Index* row)>& near,
                              const std::vector<Index>& subset, const Context& context) {
  const Positions& points = index.points();
  if (subset.size() <= kThinNear) return first_of(subset);
  std::vector<Index> number(points.size(), kNone);
  for_each_index(context, subset.size(), [&](std::size_t s) { number[subset[s]] = Index(s); });
  NeighborTable three = {int(kThinNear), {}};
  three.items.resize(kThinNear * subset.size());
  for_blocks(context, subset.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> found;
    std::vector<Index> row(width);
    for (std::size_t s = begin; s < end; ++s) {
      std::size_t to = 0;
      const auto offer = [&](Index j) {
        if (to < kThinNear && number[j] != kNone && j != subset[s])
          three.items[kThinNear * s + to++] = number[j];
      };
      near(subset[s], row.data());
      for (const Index j : row) offer(j);
      for (std::size_t k = 4 * width; to < kThinNear; k *= 4) {
        index.nearest(points[subset[s]], int(std::min(k, points.size())), found);
        to = 0;
        for (const Neighbor& q : found) offer(q.index);
      }
    }
  });
  const Positions at = at_rows(points, subset, context);
  return named(Thinning(at, three, kThinNear, context).run(), subset);
}

}  // namespace rfsmooth::rfs_mesh
