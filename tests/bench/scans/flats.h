/// Where a real scan is known to be flat: the truth of the benchmark of scans, found on the raw points.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/bench/scans/plane_fit.h"

namespace rfsmooth::bench {

/// A square of a plane's inside. Every row is within reach of the plane; nothing else is near.
struct Patch {
  Plane plane;              ///< fitted to this patch alone: lenses bend large planes
  std::vector<Index> rows;  ///< all of it, loud points too
  double spacing = 0;       ///< root of the area that a point has
};

/// A stretch along the line where two planes meet.
struct Crease {
  Plane one, other;         ///< fitted to the two sides, away from the line
  std::vector<Index> rows;  ///< within three spacings of the line
  double spacing = 0;
  /// To the nearer of the two planes.
  double distance(const Eigen::Vector3d& p) const {
    return std::min(std::abs(one.height(p)), std::abs(other.height(p)));
  }
};

struct Flats {
  std::size_t planes = 0;  ///< that have a patch
  std::vector<Patch> patches;
  std::vector<Crease> creases;
};

/// Looks for planes around random points: the best of many planes through three of the nearest points, grown
/// to all that is connected and within three standard deviations, the largest first. `points`: distinct.
/// Same seed, same result. O(seeds n).
Flats find_flats(const Positions& points, std::uint64_t seed);

}  // namespace rfsmooth::bench
