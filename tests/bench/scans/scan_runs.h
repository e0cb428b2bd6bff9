/// A real scan, what rfsmooth and its peers make of it, and what is left on its flat places.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/quality/ours.h"
#include "tests/bench/scans/measure_flats.h"

namespace rfsmooth::bench {

/// A cloud as read: its finite points, each place once, around a local origin, in the file's order.
struct Scan {
  std::string name;
  Positions points;
  Eigen::Vector3d origin;  ///< the local one, in the file's coordinates
  double spacing = 0;      ///< median distance to the nearest neighbour
};

/// At most `most` points: those nearest to the median of the coordinates. \throw Failure if it cannot be
/// read.
Scan read_scan(const std::filesystem::path& file, std::size_t most);

/// Turns a scan about its origin, in double precision, and forgets where that was: as if it had been
/// registered to others since it was taken.
void turn(Scan& scan);

/// rfsmooth, in the file's coordinates: their origin is where the scanner may have stood.
OurResult run_ours(const Scan& scan, const Variant& variant, int threads);

/// One of the peers, from the store if it is there.
Cleaned run_peer(const Scan& scan, const std::string& setting, const std::filesystem::path& cache,
                 int threads);

}  // namespace rfsmooth::bench
