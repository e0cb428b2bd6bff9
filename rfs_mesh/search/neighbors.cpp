#include "rfs_mesh/search/neighbors.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/avx2.h"
#include "base/parallel.h"
#include "rfs_mesh/search/leaf_neighbors.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Bins of equal width for squared distances, as many as there are: on a surface they spread evenly.
class Bins {
 public:
  Bins(const Neighbor* list, std::size_t count) {
    double farthest = 0;
    for (std::size_t i = 0; i < count; ++i) farthest = std::max(farthest, list[i].squared_distance);
    if (farthest > kLeast) scale_ = double(count) / farthest;
  }
  bool useful() const { return scale_ > 0; }
  /// Ascending with the distance, up to the count: a product rounded up may fall into one more.
  std::size_t of(const Neighbor& q) const { return std::size_t(scale_ * q.squared_distance); }

 private:
  static constexpr double kLeast = 1e-280;  // its inverse is a normal number
  double scale_ = 0;
};

constexpr std::size_t kShortList = 32;  // so few are kept sorted, or sorted at once

}  // namespace

void sort_neighbors(std::vector<Neighbor>& list) {
  const Bins bins(list.data(), list.size());
  if (list.size() <= kShortList || !bins.useful()) return std::sort(list.begin(), list.end());
  std::vector<std::size_t> end(list.size() + 3, 0);
  for (const Neighbor& q : list) ++end[bins.of(q) + 2];
  for (std::size_t b = 2; b < end.size(); ++b) end[b] += end[b - 1];
  std::vector<Neighbor> sorted(list.size());
  for (const Neighbor& q : list) sorted[end[bins.of(q) + 1]++] = q;
  for (std::size_t b = 0; b + 1 < end.size(); ++b)
    if (end[b + 1] - end[b] > 1)
      std::sort(sorted.begin() + std::ptrdiff_t(end[b]), sorted.begin() + std::ptrdiff_t(end[b + 1]));
  list.swap(sorted);
}

namespace {

using Eigen::Vector3d;

struct Pending {
  KdTree::Cursor cursor;
  double squared_distance;
};

/// The k best candidates so far, sorted.
class Nearest {
 public:
  Nearest(std::size_t k, double bound, std::vector<Neighbor>& storage) : list_(storage) {
    list_.assign(k, Neighbor{kNone, bound});
  }
  const Neighbor& worst() const { return list_.back(); }
  /// The points of a leaf at these squared distances, except `self`.
  void offer(const KdTree::Leaf& leaf, const double* squared, Index self) {
    for (std::uint32_t i = 0; i < KdTree::kLeaf; ++i)
      if (const Neighbor candidate = {leaf.id[i], squared[i]}; candidate < worst() && candidate.index != self)
        insert(candidate);
  }

 private:
  void insert(const Neighbor& candidate) {
    if (found_ < list_.size()) ++found_;
    std::size_t i = found_ - 1;
    for (; i > 0 && candidate < list_[i - 1]; --i) list_[i] = list_[i - 1];
    list_[i] = candidate;
  }

  std::vector<Neighbor>& list_;
  std::size_t found_ = 0;  ///< behind them are none yet
};

/// The same for lists so long that keeping them sorted would cost more than the search: candidates pile up to
/// twice the number and the farther half goes.
class NearestMany {
 public:
  NearestMany(std::size_t k, double bound, std::vector<Neighbor>& storage)
      : list_(storage), k_(k), worst_{kNone, bound} {
    list_.resize(2 * k + KdTree::kLeaf);
  }
  const Neighbor& worst() const { return worst_; }
  /// As above. Without a branch for each: about every other point of a leaf is a candidate.
  void offer(const KdTree::Leaf& leaf, const double* squared, Index self) {
    for (std::uint32_t i = 0; i < KdTree::kLeaf; ++i) {
      const Neighbor candidate = {leaf.id[i], squared[i]};
      list_[found_] = candidate;
      found_ += std::size_t(candidate < worst_) & std::size_t(candidate.index != self);
    }
    if (found_ >= 2 * k_) drop_farther();
  }
  void finish() {
    if (found_ > k_) drop_farther();
    list_.resize(found_);
    sort_neighbors(list_);
  }

 private:
  void drop_farther() {
    const Bins bins(list_.data(), found_);
    std::size_t below = 0, last = 0;  // the bin of the k-th, and how many are in those below
    if (bins.useful()) {
      count_.assign(found_ + 1, 0);
      for (std::size_t i = 0; i < found_; ++i) ++count_[bins.of(list_[i])];
      while (below + count_[last] < k_) below += count_[last++];
    }
    std::size_t kept = 0;
    same_.clear();
    for (std::size_t i = 0; i < found_; ++i) {
      const std::size_t bin = bins.of(list_[i]);
      if (bin == last) same_.push_back(list_[i]);
      list_[kept] = list_[i];
      kept += std::size_t(bin < last);
    }
    const auto nth = same_.begin() + std::ptrdiff_t(k_ - below - 1);
    std::nth_element(same_.begin(), nth, same_.end());
    worst_ = *nth;
    std::copy(same_.begin(), nth + 1, list_.begin() + std::ptrdiff_t(below));
    found_ = k_;
  }

  std::vector<std::uint32_t> count_;
  std::vector<Neighbor> same_;
  std::vector<Neighbor>& list_;
  std::size_t k_, found_ = 0;
  Neighbor worst_;
};

/// Visits the leaves that may hold something better than `worst()`, nearer ones first; `scan(leaf)`.
template <class Worst, class Scan>
void search(const KdTree& tree, const Vector3d& q, Worst&& worst, Scan&& scan) {
  if (tree.empty()) return;
  Pending stack[KdTree::kMostPending];
  std::size_t top = 0;
  stack[top++] = {tree.root(), squared_distance(q, tree.node(0))};
  while (top > 0) {
    Pending at = stack[--top];
    for (;;) {
      if (worst() < Neighbor{tree.node(at.cursor.node).least_id, at.squared_distance}) break;
      if (at.cursor.is_leaf()) {
        scan(tree.leaf(at.cursor.first));
        break;
      }
      Pending near = {at.cursor.left(), 0}, far = {at.cursor.right(), 0};
      near.squared_distance = squared_distance(q, tree.node(near.cursor.node));
      far.squared_distance = squared_distance(q, tree.node(far.cursor.node));
      if (Neighbor{tree.node(far.cursor.node).least_id, far.squared_distance} <
          Neighbor{tree.node(near.cursor.node).least_id, near.squared_distance})
        std::swap(near, far);
      stack[top++] = far;
      at = near;
    }
  }
}

inline void squared_distances(const KdTree::Leaf& leaf, const Vector3d& q, double* d2) {
  for (std::uint32_t i = 0; i < KdTree::kLeaf; ++i) {
    const double x = leaf.x[i] - q[0], y = leaf.y[i] - q[1], z = leaf.z[i] - q[2];
    d2[i] = (x * x + y * y) + z * z;
  }
}

/// Offers the points near q, except `self`, to `best`.
template <class Best>
void gather_nearest(const KdTree& tree, const Vector3d& q, Index self, Best& best) {
  search(
      tree, q, [&]() -> const Neighbor& { return best.worst(); },
      [&](const KdTree::Leaf& leaf) {
        double d2[KdTree::kLeaf];
        squared_distances(leaf, q, d2);
        best.offer(leaf, d2, self);
      });
}

constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// The k nearest of q within sqrt(bound) except the point `self`; rows of up to kShortList end in kNone where
/// there are fewer.
RFSMOOTH_AVX2_FLAT void find_nearest(const KdTree& tree, const Vector3d& q, Index self, std::size_t k,
                                     std::vector<Neighbor>& out, double bound = kNoBound) {
  if (k <= kShortList) {
    Nearest best(k, bound, out);
    gather_nearest(tree, q, self, best);
  } else {
    NearestMany best(k, bound, out);
    gather_nearest(tree, q, self, best);
    best.finish();
  }
}

}  // namespace

SpatialIndex::SpatialIndex(const Positions& points, const Context& context)
    : points_(points), tree_(points, context) {}

SpatialIndex::SpatialIndex(const Positions& points, KdTree tree, const Context& context)
    : points_(points), tree_(std::move(tree)) {
  tree_.follow(points, context);
}

NeighborTable SpatialIndex::nearest(int k, const Context& context) const {
  NeighborTable table;
  if (points_.size() < 2 || k < 1) return table;
  table.k = int(std::min(std::size_t(k), points_.size() - 1));
  table.items.resize(points_.size() * std::size_t(table.k));
  fill(table, nullptr, context);
  return table;
}

void SpatialIndex::renew(NeighborTable& table, const std::vector<char>& wanted,
                         const Context& context) const {
  fill(table, &wanted, context);
}

void SpatialIndex::fill(NeighborTable& table, const std::vector<char>* wanted, const Context& context) const {
  const auto width = std::size_t(table.k);
  const auto skip = [wanted](Index i) { return wanted != nullptr && (*wanted)[i] == 0; };
  constexpr std::size_t kGrain = 64;  // leaves
  for_blocks(context, tree_.leaf_count(), kGrain, [&](std::size_t begin, std::size_t end) {
    LeafNeighbors together(tree_, width);
    std::vector<Neighbor> found;
    for (std::size_t l = begin; l < end; ++l) {
      const KdTree::Leaf& leaf = tree_.leaf(std::uint32_t(l));
      if (std::all_of(leaf.id, leaf.id + KdTree::kLeaf, [&](Index i) { return i == kNone || skip(i); }))
        continue;
      const bool prepared = together.prepare(std::uint32_t(l));
      for (std::uint32_t slot = 0; slot < KdTree::kLeaf && leaf.id[slot] != kNone; ++slot) {
        const Index i = leaf.id[slot];
        if (skip(i)) continue;
        Index* const row = table.items.data() + i * width;
        if (prepared && together.find(slot, row)) continue;
        find_nearest(tree_, points_[i], i, width, found);
        for (std::size_t j = 0; j < width; ++j) row[j] = found[j].index;
        together.expect(found.back().squared_distance);
      }
    }
  });
}

std::vector<Index> nearest_points(const SpatialIndex& index, const Positions& places,
                                  const Context& context) {
  std::vector<Index> nearest(places.size());
  for_blocks(context, places.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> found;
    for (std::size_t i = begin; i < end; ++i) {
      index.nearest(places[i], 1, found);
      nearest[i] = found.front().index;
    }
  });
  return nearest;
}

NeighborTable nearest_left(const NeighborTable& near, const std::vector<char>& gone, const SpatialIndex& left,
                           const Context& context) {
  const auto width = std::size_t(near.k);
  if (left.points().size() <= width) return left.nearest(near.k, context);
  std::vector<Index> number(gone.size());
  Index next = 0;
  for (std::size_t i = 0; i < gone.size(); ++i) number[i] = gone[i] != 0 ? kNone : next++;
  NeighborTable table;
  table.k = near.k;
  table.items.resize(left.points().size() * width);
  for_blocks(context, gone.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> found;
    for (std::size_t i = begin; i < end; ++i) {
      if (gone[i] != 0) continue;
      Index* const row = table.items.data() + number[i] * width;
      std::transform(near[i].begin(), near[i].end(), row, [&](Index j) { return number[j]; });
      if (std::find(row, row + width, kNone) == row + width) continue;
      find_nearest(left.tree(), left.points()[number[i]], number[i], width, found);
      for (std::size_t k = 0; k < width; ++k) row[k] = found[k].index;
    }
  });
  return table;
}

void SpatialIndex::nearest(const Vector3d& query, int k, std::vector<Neighbor>& out) const {
  out.clear();
  if (k < 1 || points_.empty()) return;
  find_nearest(tree_, query, kNone, std::min(std::size_t(k), points_.size()), out);
}

SpatialIndex SpatialIndex::without(const std::vector<char>& gone, const Context& context) const {
  KdTree left = tree_;
  left.leave_out(gone, context);
  return {points_, std::move(left)};
}

void SpatialIndex::nearest_within(const Vector3d& query, int k, double bound,
                                  std::vector<Neighbor>& out) const {
  out.clear();
  if (k < 1 || points_.empty()) return;
  find_nearest(tree_, query, kNone, std::min(std::size_t(k), points_.size()), out, bound);
  while (!out.empty() && out.back().index == kNone) out.pop_back();
}

namespace {

/// Writes the points of a leaf that are within the bound to `out`, which has room for all; returns how many.
RFSMOOTH_AVX2
std::size_t write_within(const KdTree::Leaf& leaf, const Vector3d& q, double bound, Neighbor* out) {
  double d2[KdTree::kLeaf];
  squared_distances(leaf, q, d2);
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < KdTree::kLeaf; ++i) {
    out[count] = {leaf.id[i], d2[i]};
    count += std::size_t((d2[i] <= bound) & (leaf.id[i] != kNone));
  }
  return count;
}

}  // namespace

void SpatialIndex::within_unsorted(const Vector3d& query, double radius, std::vector<Neighbor>& out) const {
  if (!(radius >= 0)) return out.clear();
  const Neighbor limit = {kNone, radius * radius};
  std::size_t found = 0;
  search(
      tree_, query, [&]() -> const Neighbor& { return limit; },
      [&](const KdTree::Leaf& leaf) {
        if (out.size() < found + KdTree::kLeaf) out.resize(2 * found + KdTree::kLeaf);
        found += write_within(leaf, query, limit.squared_distance, out.data() + found);
      });
  out.resize(found);
}

void SpatialIndex::within(const Vector3d& query, double radius, std::vector<Neighbor>& out) const {
  within_unsorted(query, radius, out);
  std::sort(out.begin(), out.end());
}

bool SpatialIndex::any_within(const Vector3d& query, double radius) const {
  if (!(radius >= 0)) return false;
  constexpr double kNothingMore = -1;
  Neighbor limit = {kNone, radius * radius};
  search(
      tree_, query, [&]() -> const Neighbor& { return limit; },
      [&](const KdTree::Leaf& leaf) {
        Neighbor found[KdTree::kLeaf];
        if (write_within(leaf, query, limit.squared_distance, found) > 0)
          limit.squared_distance = kNothingMore;
      });
  return limit.squared_distance == kNothingMore;
}

}  // namespace rfsmooth::rfs_mesh
