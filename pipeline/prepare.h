/// What is done with a cloud before its points are connected or measured: `denoise`, the tiles' statistics,
/// `info`, `report` and `mesh` do it here, so that they work on the same points and say the same spacing and
/// noise.
///
/// Rows that are not finite are in no working cloud, and rows at one place are one point of it (points.h).
/// Here twins are joined (twins.h) and outliers set aside (outliers.h): both stay rows of the cloud, and no
/// distance, fit or figure knows of an outlier.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/denoise.h>
#include <rfsmooth/statistics.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::pipeline {

/// Who is near whom in a working cloud, and which rows have no part in it.
struct Prepared {
  std::optional<rfs_mesh::SpatialIndex> index;  ///< of the points that are left
  rfs_mesh::NeighborTable near;                 ///< their nearest
  std::vector<char> outlier;                    ///< n: rows set aside; empty if there are none
};

/// Joins twins, sets outliers aside (unless they are to be smoothed like all others) and finds the
/// `neighbours` nearest of the points that are left. What `whole` has not of the box, and of the reach and
/// the noise where outliers are looked for, is measured and entered. \param cloud as made of its rows; must
/// outlive what is returned and not move. \param seconds the times of the stages are added to it. O(n log n),
/// about 200 bytes a point, parallel, deterministic. Thread safe for different clouds.
Prepared prepare(rfs_mesh::WorkingCloud& cloud, int neighbours, Outliers outliers, Statistics& whole,
                 std::vector<StageTime>& seconds, const Context& context);

/// What can be said of a cloud before it is connected.
struct Measured {
  std::size_t finite = 0, distinct = 0;  ///< rows, and places among them
  Statistics statistics;                 ///< box, reach, noise, spacing and scale
  std::vector<char> outlier;             ///< as in Prepared
  Positions points;                      ///< those measured on, world units around the middle of the box
};

/// The same of n x 3 coordinates in world units, for which nobody wants neighbours: a quarter of the memory
/// of `denoise` does, so that there may be more points than are smoothed at once. \param known is taken.
/// \throw Failure (no_usable_points).
Measured measure_points(std::vector<double> xyz, Outliers outliers, Statistics known, const Context& context);

}  // namespace rfsmooth::pipeline
