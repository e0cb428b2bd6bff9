#include "rfs_mesh/search/wide_neighbors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/avx2.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// How much farther than the k-th neighbour of the place before to look, in units of its relative spread 1 /
/// sqrt(k).
constexpr double kWiden = 1;
constexpr double kLeastGrowth = 1.3;  // of the squared distance after too few were found
constexpr std::int32_t kBins = 128;

/// Offsets of the points of a leaf and their squares, in units of the bound. Returns how many are within it.
RFSMOOTH_AVX2
std::size_t look(const KdTree::Leaf& leaf, const Eigen::Vector3d& place, double scale, float* squared,
                 float* x, float* y, float* z) {
  const double x0 = place[0], y0 = place[1], z0 = place[2];
  std::int32_t within = 0;
  for (std::size_t i = 0; i < KdTree::kLeaf; ++i) {
    x[i] = float((leaf.x[i] - x0) * scale);
    y[i] = float((leaf.y[i] - y0) * scale);
    z[i] = float((leaf.z[i] - z0) * scale);
    squared[i] = (x[i] * x[i] + y[i] * y[i]) + z[i] * z[i];
  }
  for (std::size_t i = 0; i < KdTree::kLeaf; ++i) within += std::int32_t(squared[i] <= 1);
  return std::size_t(within);
}

typedef float LeafFloats __attribute__((vector_size(KdTree::kLeaf * sizeof(float))));
typedef std::int32_t LeafWholes __attribute__((vector_size(KdTree::kLeaf * sizeof(std::int32_t))));
typedef std::uint8_t LeafBytes __attribute__((vector_size(KdTree::kLeaf)));

/// The bins of squared distances up to 1; kBins beyond. `count`: a multiple of kLeaf.
RFSMOOTH_AVX2
void bins_of(const float* squared, std::size_t count, std::uint8_t* bin) {
  for (std::size_t first = 0; first < count; first += KdTree::kLeaf) {
    LeafFloats square;
    std::memcpy(&square, squared + first, sizeof square);
    const LeafWholes beyond = square > 1;
    const LeafFloats inside = square > 1 ? LeafFloats{} : square * float(kBins);
    const LeafWholes at = __builtin_convertvector(inside, LeafWholes);
    const LeafWholes found = beyond ? LeafWholes{} + kBins : at < kBins ? at : LeafWholes{} + (kBins - 1);
    const LeafBytes bytes = __builtin_convertvector(found, LeafBytes);
    std::memcpy(bin + first, &bytes, sizeof bytes);
  }
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
}

void WideNeighbors::find(const Eigen::Vector3d& place, std::size_t k) {
  k = std::min(k, index_.points().size());
  if (k_ > 0) guess_ *= double(k) / double(k_);  // as the area of a ball's surface grows
  k_ = k;
  find(place);
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
    const std::size_t within = gather(place, bound);
    if (within >= k_) break;
    bound *= std::max(kLeastGrowth, 1.1 * double(k_) / double(within + 1));
  }
  select();
  guess_ = double(farthest_) * bound;
}

/// Keeps the points of all leaves within the bound, in its units; returns how many of them are, too.
std::size_t WideNeighbors::gather(const Eigen::Vector3d& place, double squared_bound) {
  unit_ = std::sqrt(squared_bound);
  kept_ = 0;
  std::size_t within = 0;
  const KdTree& tree = index_.tree();
  const double scale = 1 / unit_;
  tree.for_each_leaf(
      [&](const KdTree::Cursor& at) { return squared_distance(place, tree.node(at.node)) <= squared_bound; },
      [&](const KdTree::Cursor& at) {
        const KdTree::Leaf& leaf = tree.leaf(at.first);
        if (kept_ + KdTree::kLeaf > x_.size()) make_room(2 * x_.size());
        within += look(leaf, place, scale, squared_.data() + kept_, x_.data() + kept_, y_.data() + kept_,
                       z_.data() + kept_);
        std::copy(leaf.id, leaf.id + KdTree::kLeaf, id_.data() + kept_);
        kept_ += KdTree::kLeaf;
        return true;
      });
  return within;
}

/// Leaves the k nearest.
void WideNeighbors::select() {
  bins_of(squared_.data(), kept_, bin_.data());
  std::array<std::size_t, kBins + 1> count = {};
  for (std::size_t i = 0; i < kept_; ++i) ++count[bin_[i]];
  std::uint8_t last = 0;
  std::size_t below = 0;
  while (below + count[last] < k_) below += count[last++];
  if (last_bin_.size() <= count[last]) last_bin_.resize(2 * count[last] + 1);
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
