#include "rfs_mesh/search/wide_neighbors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/avx2.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// How much farther than the k-th neighbour of the place before to look, in units of its relative spread 1 /
/// sqrt(k).
constexpr double kWiden = 1;
constexpr double kLeastGrowth = 1.3;  // of the squared distance after too few were found
constexpr int kBins = 128;

/// Appends the points of a leaf within the bound, in its units; returns how many there are then.
RFSMOOTH_AVX2
std::size_t keep(const KdTree::Leaf& leaf, const Eigen::Vector3d& place, double scale, std::size_t kept,
                 float* squared, float* x, float* y, float* z, Index* id) {
  const double x0 = place[0], y0 = place[1], z0 = place[2];
  float dx[KdTree::kLeaf], dy[KdTree::kLeaf], dz[KdTree::kLeaf], square[KdTree::kLeaf];
  for (std::size_t i = 0; i < KdTree::kLeaf; ++i) {
    dx[i] = float((leaf.x[i] - x0) * scale);
    dy[i] = float((leaf.y[i] - y0) * scale);
    dz[i] = float((leaf.z[i] - z0) * scale);
    square[i] = (dx[i] * dx[i] + dy[i] * dy[i]) + dz[i] * dz[i];
  }
  for (std::size_t i = 0; i < KdTree::kLeaf; ++i) {
    squared[kept] = square[i];
    x[kept] = dx[i];
    y[kept] = dy[i];
    z[kept] = dz[i];
    id[kept] = leaf.id[i];
    kept += std::size_t(square[i] <= 1);
  }
  return kept;
}

}  // namespace

WideNeighbors::WideNeighbors(const SpatialIndex& index, std::size_t k)
    : index_(index), k_(std::min(k, index.points().size())) {
  make_room(2 * k_ + KdTree::kLeaf);
}

void WideNeighbors::make_room(std::size_t size) {
  squared_.resize(size);
  x_.resize(size);
  y_.resize(size);
  z_.resize(size);
  id_.resize(size);
  bin_.resize(size);
  last_bin_.resize(size);
}

void WideNeighbors::find(const Eigen::Vector3d& place) {
  kept_ = 0;
  if (k_ == 0) return;
  if (!(guess_ > 0)) {
    index_.nearest(place, int(k_), first_);
    guess_ = first_.back().squared_distance;
  }
  double bound = guess_ * std::pow(1 + kWiden / std::sqrt(double(k_)), 2);
  bound = std::max(bound, std::numeric_limits<double>::min());
  for (;;) {
    gather(place, bound);
    if (kept_ >= k_) break;
    bound *= std::max(kLeastGrowth, 1.1 * double(k_) / double(kept_ + 1));
  }
  select();
  guess_ = double(farthest_) * bound;
}

/// Keeps the points within the bound, in its units.
void WideNeighbors::gather(const Eigen::Vector3d& place, double squared_bound) {
  unit_ = std::sqrt(squared_bound);
  kept_ = 0;
  const KdTree& tree = index_.tree();
  const double scale = 1 / unit_;
  KdTree::Cursor stack[64];
  std::size_t top = 0;
  stack[top++] = tree.root();
  while (top > 0) {
    KdTree::Cursor at = stack[--top];
    while (squared_distance(place, tree.node(at.node)) <= squared_bound) {
      if (!at.is_leaf()) {
        stack[top++] = at.right();
        at = at.left();
        continue;
      }
      const KdTree::Leaf& leaf = tree.leaf(at.first);
      if (kept_ + KdTree::kLeaf > x_.size()) make_room(2 * x_.size());
      kept_ = keep(leaf, place, scale, kept_, squared_.data(), x_.data(), y_.data(), z_.data(), id_.data());
      break;
    }
  }
}

/// Leaves the k nearest.
void WideNeighbors::select() {
  std::array<std::size_t, kBins> count = {};
  for (std::size_t i = 0; i < kept_; ++i) {
    bin_[i] = std::uint8_t(std::min(int(squared_[i] * kBins), kBins - 1));
    ++count[bin_[i]];
  }
  std::uint8_t last = 0;
  std::size_t below = 0;
  while (below + count[last] < k_) below += count[last++];
  std::size_t kept = 0, in_last = 0;
  for (std::size_t i = 0; i < kept_; ++i) {
    const Item item = {squared_[i], x_[i], y_[i], z_[i], id_[i]};
    last_bin_[in_last] = item;
    in_last += std::size_t(bin_[i] == last);
    squared_[kept] = item.squared;
    x_[kept] = item.x;
    y_[kept] = item.y;
    z_[kept] = item.z;
    id_[kept] = item.id;
    kept += std::size_t(bin_[i] < last);
  }
  const auto begin = last_bin_.begin(), middle = begin + std::ptrdiff_t(k_ - below - 1);
  std::nth_element(begin, middle, begin + std::ptrdiff_t(in_last), [](const Item& a, const Item& b) {
    return a.squared != b.squared ? a.squared < b.squared : a.id < b.id;
  });
  farthest_ = middle->squared;
  for (auto item = begin; item <= middle; ++item, ++kept) {
    squared_[kept] = item->squared;
    x_[kept] = item->x;
    y_[kept] = item->y;
    z_[kept] = item->z;
    id_[kept] = item->id;
  }
  kept_ = kept;
}

}  // namespace rfsmooth::rfs_mesh
