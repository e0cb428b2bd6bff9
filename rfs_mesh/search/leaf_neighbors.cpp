#include "rfs_mesh/search/leaf_neighbors.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "base/avx2.h"

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

/// Above this many kept points the farther ones are dropped before they are ranked (ranking is quadratic).
std::size_t most_ranked(std::size_t k) {
  return 64 + 2 * k;
}

/// Coordinates farther from the leaf's middle than this, in units of the bound, leave single precision too
/// little to tell distances by.
constexpr double kFarthest = 16;
constexpr double kLeastBound = 1e-280;  // its root and its inverse are normal numbers

constexpr std::size_t kLanes = 8;
typedef float Keys __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Counts __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

std::size_t padded(std::size_t count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

/// Squared distances of `count` points from (qx, qy, qz).
RFSMOOTH_AVX2
void squared_distances(const float* __restrict x, const float* __restrict y, const float* __restrict z,
                       std::size_t count, float qx, float qy, float qz, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - qx, dy = y[i] - qy, dz = z[i] - qz;
    out[i] = (dx * dx + dy * dy) + dz * dz;
  }
}

/// How many of `count` keys are less than each of them; both padded.
RFSMOOTH_AVX2
void count_nearer(const float* key, std::size_t count, std::uint32_t* nearer) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    Keys own;
    std::memcpy(&own, key + i, sizeof own);
    Counts less = {};
    for (std::size_t j = 0; j < count; ++j) less -= key[j] < own;
    std::memcpy(nearer + i, &less, sizeof less);
  }
}

/// For every set of eight flags the places of those that are set.
struct SetPlaces {
  std::uint16_t place[256][kLeaf] = {};
  std::uint8_t count[256] = {};
  constexpr SetPlaces() {
    for (unsigned flags = 0; flags < 256; ++flags)
      for (unsigned i = 0; i < kLeaf; ++i)
        if ((flags >> i & 1) != 0) place[flags][count[flags]++] = std::uint16_t(i);
  }
};
constexpr SetPlaces kSetPlaces;

/// The places of the keys up to `most` into `out`, which has room for all and eight more; returns how many.
std::size_t places_up_to(const float* key, std::size_t count, float most, std::uint16_t* out) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; i += kLeaf) {
#ifdef __SSE2__
    const __m128 limit = _mm_set1_ps(most);
    const __m128i low = _mm_castps_si128(_mm_cmple_ps(_mm_loadu_ps(key + i), limit));
    const __m128i high = _mm_castps_si128(_mm_cmple_ps(_mm_loadu_ps(key + i + 4), limit));
    const __m128i both = _mm_packs_epi32(low, high);
    const auto flags = std::size_t(_mm_movemask_epi8(_mm_packs_epi16(both, _mm_setzero_si128())));
    const __m128i places = _mm_loadu_si128(reinterpret_cast<const __m128i*>(kSetPlaces.place[flags]));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out + kept), _mm_add_epi16(places, _mm_set1_epi16(short(i))));
    kept += kSetPlaces.count[flags];
#else
    for (std::size_t j = i; j < i + kLeaf; ++j) {
      out[kept] = std::uint16_t(j);
      kept += std::size_t(key[j] <= most);
    }
#endif
  }
  return kept;
}

}  // namespace

void LeafNeighbors::list_leaves(const KdTree::Node& box, double squared_bound) {
  list_.clear();
  tree_.for_each_leaf(
      [&](const KdTree::Cursor& at) { return squared_distance(box, tree_.node(at.node)) <= squared_bound; },
      [&](const KdTree::Cursor& leaf) {
        list_.push_back(leaf.first);
        return list_.size() <= longest_list(k_);
      });
}

LeafNeighbors::LeafNeighbors(const KdTree& tree, std::size_t k) : tree_(tree), k_(k) {
  const double spread = 1 / std::sqrt(double(k));
  widen_ = std::pow(1 + kWidenPoint * spread, 2);
  widen_list_ = std::pow(1 + kWidenLeaf * spread, 2);
}

bool LeafNeighbors::prepare(std::uint32_t leaf) {
  leaf_ = &tree_.leaf(leaf);
  KdTree::Node box;
  box.low = box.high = leaf_->point(0);
  for (std::uint32_t slot = 1; slot < kLeaf && leaf_->id[slot] != kNone; ++slot)
    box.extend(leaf_->point(slot));
  list_bound_ = guess_ * widen_list_;
  if (!(list_bound_ > kLeastBound)) return false;  // nothing is known yet, or all points coincide
  list_leaves(box, list_bound_);
  if (list_.size() > longest_list(k_) || list_.size() * kLeaf > 0xffff) return false;
  const double farthest = 0.5 * (box.high - box.low).maxCoeff() / std::sqrt(list_bound_) + 1;
  if (farthest > kFarthest) return false;
  // A coordinate is off by 2^-24 of the farthest, a difference by twice that and 2^-24 of itself; three of
  // them, squared, of points within the bound: below this.
  uncertain_ = float(5e-7 * (farthest + 1));
  load_listed(box);
  return true;
}

void LeafNeighbors::load_listed(const KdTree::Node& box) {
  const Vector3d middle = 0.5 * (box.low + box.high);
  const double scale = 1 / std::sqrt(list_bound_), cx = middle[0], cy = middle[1], cz = middle[2];
  const std::size_t count = list_.size() * kLeaf;
  if (x_.size() < count) {
    for (auto* all : {&x_, &y_, &z_, &key_}) all->resize(2 * count);
    kept_.resize(2 * count + kLeaf);
  }
  for (std::size_t l = 0; l < list_.size(); ++l) {
    const KdTree::Leaf& leaf = tree_.leaf(list_[l]);
    float *const x = x_.data() + l * kLeaf, *const y = y_.data() + l * kLeaf,
                 *const z = z_.data() + l * kLeaf;
    for (std::size_t i = 0; i < kLeaf; ++i) x[i] = float((leaf.x[i] - cx) * scale);
    for (std::size_t i = 0; i < kLeaf; ++i) y[i] = float((leaf.y[i] - cy) * scale);
    for (std::size_t i = 0; i < kLeaf; ++i) z[i] = float((leaf.z[i] - cz) * scale);
  }
  for (std::size_t i = 0; i < kLeaf; ++i) {
    own_x_[i] = float((leaf_->x[i] - cx) * scale);
    own_y_[i] = float((leaf_->y[i] - cy) * scale);
    own_z_[i] = float((leaf_->z[i] - cz) * scale);
  }
}

double LeafNeighbors::squared_distance_to(std::uint32_t slot, std::uint32_t place) const {
  return squared_distance(leaf_->point(slot), tree_.leaf(list_[place / kLeaf]).point(place % kLeaf));
}

Index LeafNeighbors::id_at(std::uint32_t place) const {
  return tree_.leaf(list_[place / kLeaf]).id[place % kLeaf];
}

/// Leaves of the kept points those that may be among the k nearest and the point itself.
void LeafNeighbors::drop_farther() {
  sorted_.assign(kept_key_.begin(), kept_key_.begin() + std::ptrdiff_t(kept_count_));
  std::nth_element(sorted_.begin(), sorted_.begin() + std::ptrdiff_t(k_), sorted_.end());
  const float most = sorted_[k_] + 2 * uncertain_;
  std::size_t to = 0;
  for (std::size_t i = 0; i < kept_count_; ++i) {
    kept_[to] = kept_[i];
    kept_key_[to] = kept_key_[i];
    to += std::size_t(kept_key_[to] <= most);
  }
  kept_count_ = to;
}

/// Places (place_, sorted_) every kept point by the number of nearer ones. False if among the k nearest or
/// behind them two are not told apart.
bool LeafNeighbors::rank() {
  const std::size_t room = padded(kept_count_);
  for (auto* all : {&place_, &nearer_})
    if (all->size() < room) all->resize(2 * room);
  if (sorted_.size() < room) sorted_.resize(2 * room);
  std::fill(kept_key_.begin() + std::ptrdiff_t(kept_count_), kept_key_.begin() + std::ptrdiff_t(room),
            std::numeric_limits<float>::infinity());
  count_nearer(kept_key_.data(), room, nearer_.data());
  std::size_t sum = 0;
  for (std::size_t i = 0; i < kept_count_; ++i) {
    sum += nearer_[i];
    place_[nearer_[i]] = kept_[i];
    sorted_[nearer_[i]] = kept_key_[i];
  }
  if (2 * sum != kept_count_ * (kept_count_ - 1)) {
    rank_equal();
    return false;
  }
  const std::size_t last = std::min(k_ + 1, kept_count_ - 1);
  int close = 0;
  for (std::size_t r = 0; r < last; ++r) close |= int(sorted_[r + 1] - sorted_[r] <= 2 * uncertain_);
  return close == 0;
}

/// The same where keys are equal: one of them behind the other.
void LeafNeighbors::rank_equal() {
  taken_.assign(kept_count_, 0);
  for (std::size_t i = 0; i < kept_count_; ++i) {
    const std::size_t r = nearer_[i] + taken_[nearer_[i]]++;
    place_[r] = kept_[i];
    sorted_[r] = kept_key_[i];
  }
}

/// Places the ranked points that are not told apart in double precision, ties by index; the point itself is
/// put before all others. Points of keys that are farther apart are in their order.
void LeafNeighbors::tell_apart(std::uint32_t slot) {
  for (std::size_t first = 0, end = 1; first <= k_; first = end++) {
    while (end < kept_count_ && sorted_[end] - sorted_[end - 1] <= 2 * uncertain_) ++end;
    if (end == first + 1) continue;
    exact_.clear();
    for (std::size_t r = first; r < end; ++r) {
      const Index id = id_at(place_[r]);
      exact_.push_back({id == leaf_->id[slot] ? -1 : squared_distance_to(slot, place_[r]), id, place_[r]});
    }
    std::sort(exact_.begin(), exact_.end());
    for (std::size_t r = first; r < end; ++r) place_[r] = exact_[r - first].place;
  }
}

/// Looks as far as `share` of the (squared) bound. False if less than k points are there.
bool LeafNeighbors::find_within(std::uint32_t slot, double share) {
  const std::size_t count = list_.size() * kLeaf;
  kept_count_ = places_up_to(key_.data(), count, float(share) + 2 * uncertain_, kept_.data());
  if (kept_count_ <= k_) return false;
  const std::size_t room = padded(kept_count_);
  if (kept_key_.size() < room) kept_key_.resize(2 * room);
  for (std::size_t i = 0; i < kept_count_; ++i) kept_key_[i] = key_[kept_[i]];
  if (kept_count_ > most_ranked(k_)) drop_farther();
  if (kept_count_ > most_ranked(k_)) {  // equally far
    place_.assign(kept_.begin(), kept_.begin() + std::ptrdiff_t(kept_count_));
    sorted_.assign(kept_count_, 0);
    tell_apart(slot);
  } else if (!rank()) {
    tell_apart(slot);
  }
  guess_ = squared_distance_to(slot, place_[k_]);
  return guess_ <= share * list_bound_;
}

bool LeafNeighbors::find(std::uint32_t slot, Index* row) {
  squared_distances(x_.data(), y_.data(), z_.data(), list_.size() * kLeaf, own_x_[slot], own_y_[slot],
                    own_z_[slot], key_.data());
  const double before = guess_;
  if (!find_within(slot, std::min(1.0, before * widen_ / list_bound_)) && !find_within(slot, 1)) {
    guess_ = before;
    return false;
  }
  for (std::size_t j = 0; j < k_; ++j) row[j] = id_at(place_[j + 1]);
  return true;
}

}  // namespace rfsmooth::rfs_mesh
