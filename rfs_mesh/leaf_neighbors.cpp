#include "rfsmooth/rfs_mesh/leaf_neighbors.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "rfsmooth/rfs_mesh/wide.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

constexpr std::uint32_t kLeaf = KdTree::kLeaf;

/// How much farther than the last point's k-th neighbour to look, in units of its relative spread 1 /
/// sqrt(k). Measured on noisy tori and spheres, k = 8 and 32: flat from 0.5 to 1 and from 1.5 to 2.5; about 5
/// % of the points need the second look, 2 % a search of their own.
constexpr double kWidenPoint = 0.7, kWidenLeaf = 2;

/// Leaves listed before the walk is given up: a few times what evenly spread points in space need.
std::size_t longest_list(std::size_t k) {
  return 256 + 4 * k;
}

/// Above this many kept points the k nearest are selected before they are ranked (ranking is quadratic).
std::size_t most_ranked(std::size_t k) {
  return 64 + 2 * k;
}

constexpr std::size_t kLanes = 8;
typedef float Keys __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Counts __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

inline void squared_distances(const KdTree::Leaf& leaf, const Vector3d& q, double* __restrict d2) {
  const double x0 = q[0], y0 = q[1], z0 = q[2];
  for (std::uint32_t i = 0; i < kLeaf; ++i) {
    const double x = leaf.x[i] - x0, y = leaf.y[i] - y0, z = leaf.z[i] - z0;
    d2[i] = (x * x + y * y) + z * z;
  }
}

/// Keeps the points of the leaves within the bound, except `self`; returns how many.
RFSMOOTH_WIDE
std::size_t keep(const KdTree& tree, const std::uint32_t* leaves, std::size_t count, const Vector3d& q,
                 Index self, double squared_bound, double* distance, Index* id) {
  std::size_t kept = 0;
  for (std::size_t l = 0; l < count; ++l) {
    const KdTree::Leaf& leaf = tree.leaf(leaves[l]);
    double d2[kLeaf];
    squared_distances(leaf, q, d2);
    for (std::uint32_t i = 0; i < kLeaf; ++i) {
      distance[kept] = d2[i];
      id[kept] = leaf.id[i];
      kept += std::size_t(int(d2[i] <= squared_bound) & int(leaf.id[i] != self));
    }
  }
  return kept;
}

/// place[number of smaller keys] of each of the keys, which are padded with larger ones; returns the sum of
/// these numbers.
RFSMOOTH_WIDE
std::size_t place_by_rank(const float* key, std::size_t kept, std::uint32_t* place) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < kept; i += kLanes) {
    Keys own;
    std::memcpy(&own, key + i, sizeof own);
    Counts nearer = {};
    for (std::size_t j = 0; j < kept; ++j) nearer -= key[j] < own;
    for (std::size_t lane = 0; lane < std::min(kLanes, kept - i); ++lane) {
      sum += std::size_t(nearer[lane]);
      place[std::size_t(nearer[lane])] = std::uint32_t(i + lane);
    }
  }
  return sum;
}

}  // namespace

void LeafNeighbors::list_leaves(const KdTree::Node& box, double squared_bound) {
  list_.clear();
  boxes_.clear();
  KdTree::Cursor stack[64];
  std::size_t top = 0;
  stack[top++] = tree_.root();
  while (top > 0) {
    KdTree::Cursor at = stack[--top];
    while (squared_distance(box, tree_.node(at.node)) <= squared_bound) {
      if (at.is_leaf()) {
        list_.push_back(at.first);
        boxes_.push_back(tree_.node(at.node));
        if (list_.size() > longest_list(k_)) return;
        break;
      }
      stack[top++] = at.right();
      at = at.left();
    }
  }
}

LeafNeighbors::LeafNeighbors(const KdTree& tree, std::size_t k) : tree_(tree), k_(k) {
  const double spread = 1 / std::sqrt(double(k));
  widen_ = std::pow(1 + kWidenPoint * spread, 2);
  widen_list_ = std::pow(1 + kWidenLeaf * spread, 2);
}

bool LeafNeighbors::prepare(std::uint32_t leaf) {
  leaf_ = &tree_.leaf(leaf);
  KdTree::Node box;
  box.low = box.high = point(0);
  for (std::uint32_t slot = 1; slot < kLeaf && leaf_->id[slot] != kNone; ++slot) {
    box.low = box.low.cwiseMin(point(slot));
    box.high = box.high.cwiseMax(point(slot));
  }
  list_bound_ = guess_ * widen_list_;
  list_leaves(box, list_bound_);
  return list_.size() <= longest_list(k_);
}

/// Keeps the points within the bound, except `self`, in distance_ and id_.
void LeafNeighbors::keep_within(const Vector3d& q, Index self, double squared_bound) {
  near_.resize(list_.size());
  std::size_t near = 0;
  for (std::size_t l = 0; l < list_.size(); ++l) {
    near_[near] = list_[l];
    near += std::size_t(squared_distance(q, boxes_[l]) <= squared_bound);
  }
  distance_.resize((near + 1) * kLeaf);
  id_.resize((near + 1) * kLeaf);
  kept_ = keep(tree_, near_.data(), near, q, self, squared_bound, distance_.data(), id_.data());
}

/// Places (place_) every kept point by the number of nearer ones. False if two look equally far.
/// Compares single-precision keys, four times as many at once as doubles: rounding is monotone, so keys that
/// differ are in the order of the distances.
bool LeafNeighbors::rank(double squared_bound) {
  const std::size_t kept = kept_, padded = (kept + kLanes - 1) / kLanes * kLanes;
  key_.resize(padded);
  place_.resize(padded);
  const double scale = 1 / squared_bound;
  for (std::size_t i = 0; i < kept; ++i) key_[i] = float(distance_[i] * scale);
  for (std::size_t i = kept; i < padded; ++i) key_[i] = 2;
  return 2 * place_by_rank(key_.data(), kept, place_.data()) == kept * (kept - 1);
}

void LeafNeighbors::sort() {
  place_.resize(kept_);
  std::iota(place_.begin(), place_.end(), 0u);
  std::partial_sort(place_.begin(), place_.begin() + std::ptrdiff_t(k_), place_.end(),
                    [&](std::uint32_t a, std::uint32_t b) {
                      return distance_[a] != distance_[b] ? distance_[a] < distance_[b] : id_[a] < id_[b];
                    });
}

bool LeafNeighbors::find(std::uint32_t slot, Index* row) {
  const Vector3d q = point(slot);
  double bound = std::min(guess_ * widen_, list_bound_);
  keep_within(q, leaf_->id[slot], bound);
  if (kept_ < k_) keep_within(q, leaf_->id[slot], bound = list_bound_);
  if (kept_ < k_) return false;
  if (kept_ > most_ranked(k_) || !rank(bound)) sort();
  for (std::size_t j = 0; j < k_; ++j) row[j] = id_[place_[j]];
  guess_ = distance_[place_[k_ - 1]];
  return true;
}

}  // namespace rfsmooth::rfs_mesh
