/// Where laser scanners stood that tell ranges in steps (depth_steps.h), whatever became of their coordinates
/// since: registered, moved, or put beside other scans.
///
/// Points that are told the same range lie on a shell around the scanner, so the plane halfway between two of
/// them goes through it, and three such planes meet there: found by random sample consensus (Fischler and
/// Bolles 1981) among pairs of neighbours. Points far apart on one shell then tell the place to more digits.
#pragma once

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Places from which a tenth of all neighbours or more are as far as each other, the one with the most first.
/// They may mean nothing where points are on circles about one axis. \param same how far apart two ranges may
/// be that are one, world units, > 0. O(log n): looks at 1,000 points, and at up to 50,000 once it has found
/// a place. Deterministic.
Positions scanner_places(const SpatialIndex& index, double same);

}  // namespace rfsmooth::rfs_mesh
