/// Quantiles and the median: always one of the values, not a mean of two. They reorder the values, none of
/// which may be NaN. O(n). Thread safe for different values.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace rfsmooth {

/// The value of [first, last) that has `share` (0 to 1) of the other values below it, their number rounded
/// down. Precondition: there is a value.
template <class Iterator>
double quantile(Iterator first, Iterator last, double share) {
  const Iterator at = first + std::ptrdiff_t(share * double(last - first - 1));
  std::nth_element(first, at, last);
  return *at;
}

/// The same of `values`.
inline double quantile(std::vector<double>& values, double share) {
  return quantile(values.begin(), values.end(), share);
}

/// The same of `value(item)`, a member or what a function makes of each item.
template <class Items, class Value>
double quantile_of(const Items& items, double share, const Value& value) {
  std::vector<double> values;
  values.reserve(items.size());
  for (const auto& item : items) values.push_back(std::invoke(value, item));
  return quantile(values, share);
}

/// The median of [first, last): of an even number of values the upper of the two in the middle, of none 0.
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

/// The nth smallest (from 0, nth < count) of the first `count` values, which must be finite; the rest of the
/// array is overwritten. Compares every value with every other: for few values that is faster than the
/// unpredictable branches of a selection. O(count^2).
template <std::size_t kMost>
float nth_of_few(std::array<float, kMost>& values, std::size_t count, std::size_t nth) {
  static_assert(kMost % 4 == 0);
  const std::size_t padded = (count + 3) / 4 * 4;
  for (std::size_t i = count; i < padded; ++i) values[i] = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    const float value = values[i];
    std::uint32_t less = 0, same = 0;
    for (std::size_t j = 0; j < padded; ++j) {
      less += std::uint32_t(values[j] < value);
      same += std::uint32_t(values[j] == value);
    }
    if (less <= nth && nth < std::size_t(less) + same) return value;
  }
  return values[0];
}

}  // namespace rfsmooth
