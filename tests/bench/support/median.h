/// The median of a figure over rounds: of an even number the mean of the two in the middle; 0 of none.
#pragma once

#include <algorithm>
#include <vector>

namespace rfsmooth::bench {

inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

}  // namespace rfsmooth::bench
