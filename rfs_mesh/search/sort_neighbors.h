/// Sorting of long lists of neighbours. Thread safe.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Sorts by (distance, index). Squared distances of points on a surface are spread evenly, so most points
/// find their place by their distance alone. O(n) for these, O(n log n) for all others.
inline void sort_neighbors(std::vector<Neighbor>& list) {
  constexpr std::size_t kShort = 32;  // sorted at once
  constexpr double kLeast = 1e-280;   // its inverse is a normal number
  double farthest = 0;
  for (const Neighbor& q : list) farthest = std::max(farthest, q.squared_distance);
  if (list.size() <= kShort || !(farthest > kLeast)) return std::sort(list.begin(), list.end());
  const double scale = double(list.size()) / farthest;
  // As many bins as points; a product rounded up may fall into one more.
  const auto bin = [&](const Neighbor& q) { return std::size_t(scale * q.squared_distance); };
  std::vector<std::size_t> end(list.size() + 3, 0);
  for (const Neighbor& q : list) ++end[bin(q) + 2];
  for (std::size_t b = 2; b < end.size(); ++b) end[b] += end[b - 1];
  std::vector<Neighbor> sorted(list.size());
  for (const Neighbor& q : list) sorted[end[bin(q) + 1]++] = q;
  for (std::size_t b = 0; b + 1 < end.size(); ++b)
    if (end[b + 1] - end[b] > 1)
      std::sort(sorted.begin() + std::ptrdiff_t(end[b]), sorted.begin() + std::ptrdiff_t(end[b + 1]));
  list.swap(sorted);
}

}  // namespace rfsmooth::rfs_mesh
