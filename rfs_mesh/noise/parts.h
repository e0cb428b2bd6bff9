/// Parts of a cloud that are so much denser than each other that each is measured, and smoothed, as a cloud
/// by itself: an object and the room that it was scanned in, a scan from the air and one from the ground,
/// what is right before a camera and what is far behind it.
///
/// One figure says how noisy a cloud is and how far apart its points are, and counts places by their area
/// (scatter_statistics.h). Of two parts with as many points each, the one that is more than 1 / kLeastPart
/// times as dense has less than kLeastPart of the area, and the figure is that of the other alone. But most
/// scans are denser here than there, little by little, with the distance from the scanner, and their noise
/// is one law of that distance: they are one cloud. So parts are those of which the densities lie apart:
///
///     r   radius of the ball of the kNeighbourhood nearest points, itself included; density goes as 1 / r^2
///
/// A radius is the bound of two parts if the median densities on its two sides differ 1 / kLeastPart times
/// and more, and if hardly a place is about as dense as a ball of that radius: of those that are neither
/// denser() nor sparser there are fewer than kLeastPart of those on either side. No part has fewer than
/// kNeighbourhood of kPlacesOfCloud places. Among several such bounds that with the fewest places about it is
/// the first, and each side is looked at again. Each point is of the part that its own r is of.
#pragma once

#include <cstddef>
#include <vector>

#include <rfsmooth/statistics.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The bounds between the parts of a cloud, ascending, world units; none: it is one. O(log n). Parallel,
/// deterministic.
std::vector<double> bounds_of_parts(const SpatialIndex& index, const Context& context);

/// The rows of the points of each part, ascending, the densest part first. \param bounds ascending.
/// O(n log n). Parallel, deterministic.
std::vector<std::vector<Index>> rows_of_parts(const SpatialIndex& index, const std::vector<double>& bounds,
                                              const Context& context);

/// Measures each part of a cloud that has some, and enters them and the noise of all: what each has at its
/// sites, and the figures of the largest that has noise. Those around the densest part that scatter as widely
/// as the widest balls of a fit are strays, have no noise, and stay. O(n log n) where there are parts, else
/// O(log n). Parallel, deterministic.
void measure_parts(const SpatialIndex& index, Statistics& whole, const Context& context);

}  // namespace rfsmooth::rfs_mesh
