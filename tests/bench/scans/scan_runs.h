/// A real scan, what rfsmooth and its peers make of it, and what is left on its flat places.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/quality/ours.h"
#include "tests/bench/scans/flats.h"

namespace rfsmooth::bench {

/// A cloud as read: its finite points, each place once, around a local origin, in the file's order.
struct Scan {
  std::string name;
  Positions points;
  double spacing = 0;  ///< median distance to the nearest neighbour
};

/// At most `most` points: those nearest to the median of the coordinates. \throw Failure if it cannot be
/// read.
Scan read_scan(const std::filesystem::path& file, std::size_t most);

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

FlatError measure_flats(const Flats& flats, const Scan& scan, const Cleaned& cleaned, int threads);

/// One of the peers, from the store if it is there.
Cleaned run_peer(const Scan& scan, const std::string& setting, const std::filesystem::path& cache,
                 int threads);

}  // namespace rfsmooth::bench
