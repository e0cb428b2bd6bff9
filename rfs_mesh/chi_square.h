/// Quantiles of the chi-square distribution. Thread safe.
#pragma once

#include <algorithm>
#include <cmath>

namespace rfsmooth::rfs_mesh {

/// What the cube root of a chi-square variable over its degrees of freedom is below as often as a standard
/// normal variable is below `deviate`; 0: its median. At least 0.1. Source: Wilson and Hilferty 1931. \param
/// freedom above 0
inline double root_of_chi_square(double freedom, double deviate) {
  const double v = 2 / (9 * freedom);
  return std::max(0.1, 1 - v + deviate * std::sqrt(v));
}

}  // namespace rfsmooth::rfs_mesh
