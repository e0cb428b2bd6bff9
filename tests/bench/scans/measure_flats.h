/// What a tool leaves of the noise on the flat places of a scan.
#pragma once

#include <vector>

#include <rfsmooth/context.h>

#include "tests/bench/scans/flats.h"

namespace rfsmooth::bench {

/// A tool's result.
struct Cleaned {
  Positions points;
  std::vector<Index> source;  ///< row of the scan of each point; empty: the same
};

/// Geometric means over the places, so that each counts the same and the ratio of two tools' is the mean of
/// their ratios; lengths in the spacings of each place. 0: there is no such place.
struct FlatError {
  double plane = 0;  ///< of a patch: rms distance to its plane, at least kLeastRough
  double normal =
      0;  ///< of a patch: degrees between the plane through the 12 nearest points and its own, mean
  double crease = 0;  ///< of a crease: rms distance to the nearer of its planes
};

inline constexpr double kLeastRough = 0.01;  ///< spacings, and degrees: nobody asks for less

/// `rows`: points of the scan that the places were found on.
FlatError measure_flats(const Flats& flats, std::size_t rows, const Cleaned& cleaned, const Context& context);

}  // namespace rfsmooth::bench
