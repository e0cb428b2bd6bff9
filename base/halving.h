/// Splits items into the lower and the upper half along an axis: the step that builds the kd-tree.
///
/// The coordinates become 31-bit integers, a histogram of these finds the median, and one pass distributes
/// the items. No loop has an unpredictable branch; selection by comparison has one per comparison and takes
/// three times as long. The split is stable, so the items of every node of the tree ascend.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace rfsmooth {

/// The split, with its scratch memory; one object per thread.
class Halving {
 public:
  /// Writes the `half` items of the least coordinates to `to` and the others behind them; both halves keep
  /// the order of `items`. Of equal coordinates the first count as lower. Coordinates are equal if they fall
  /// into the same of the 2^31 cells of [low, low + extent]; beyond an end they count as that end.
  /// `coordinate(item)` must be finite. \param half less than `count`. \param to not among `items`.
  template <class Item, class Coordinate>
  void operator()(const Item* items, std::size_t count, std::size_t half, double low, double extent, Item* to,
                  Coordinate&& coordinate) {
    if (key_.size() < count) key_.resize(count);
    const double scale = extent > kLeastExtent ? kLargestKey / extent : 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double at = (coordinate(items[i]) - low) * scale;
      key_[i] = std::uint32_t(std::min(std::max(at, 0.0), kLargestKey));
    }
    const Pivot pivot = count <= kFew ? find<6>(count, half) : find<10>(count, half);
    deal(items, count, half, pivot, to);
  }

 private:
  static constexpr double kLargestKey = 2147483647.0;
  static constexpr double kLeastExtent = 1e-290;  // kLargestKey / extent is finite above this
  static constexpr std::size_t kFew = 512;        // up to here 64 bins, beyond 1024

  /// The lower half: all items below `key` and the first `ties` items equal to it.
  struct Pivot {
    std::uint32_t key;
    std::size_t ties;
  };

  template <int kBits>
  Pivot find(std::size_t count, std::size_t half) {
    constexpr int kShift = 31 - kBits;
    std::array<std::uint32_t, std::size_t{1} << kBits> bin = {};
    for (std::size_t i = 0; i < count; ++i) ++bin[key_[i] >> kShift];
    std::uint32_t middle = 0;
    std::size_t below = 0;
    while (below + bin[middle] <= half) below += bin[middle++];
    if (inside_.size() < std::size_t(bin[middle]) + 1) inside_.resize(2 * std::size_t(bin[middle]) + 1);
    std::size_t inside = 0;
    for (std::size_t i = 0; i < count && inside < bin[middle]; ++i) {
      inside_[inside] = key_[i];
      inside += std::size_t(key_[i] >> kShift == middle);
    }
    const auto begin = inside_.begin(), nth = begin + std::ptrdiff_t(half - below);
    std::nth_element(begin, nth, begin + std::ptrdiff_t(inside));
    const auto lower = std::size_t(std::count_if(begin, nth, [&](std::uint32_t key) { return key < *nth; }));
    return {*nth, half - below - lower};
  }

  template <class Item>
  void deal(const Item* items, std::size_t count, std::size_t half, Pivot pivot, Item* to) const {
    Item *lower = to, *upper = to + half;
    std::size_t ties = pivot.ties;
    for (std::size_t i = 0; i < count; ++i) {
      const bool tie = key_[i] == pivot.key, low = key_[i] < pivot.key || (tie && ties > 0);
      ties -= std::size_t(tie && ties > 0);
      *(low ? lower : upper) = items[i];
      lower += std::size_t(low);
      upper += std::size_t(!low);
    }
  }

  std::vector<std::uint32_t> key_, inside_;
};

}  // namespace rfsmooth
