/// The median: of an even number of values the upper of the two in the middle, so that it is always one of
/// them; 0 of none. The values change places. O(n).
#pragma once

#include <algorithm>
#include <vector>

namespace rfsmooth::rfs_mesh {

/// The median of [first, last).
template <class Iterator>
double median(Iterator first, Iterator last) {
  if (first == last) return 0;
  const Iterator middle = first + (last - first) / 2;
  std::nth_element(first, middle, last);
  return *middle;
}

/// The median of `values`.
inline double median(std::vector<double>& values) {
  return median(values.begin(), values.end());
}

}  // namespace rfsmooth::rfs_mesh
