/// Twins: points that are nearly at the same place, as a cloud has that was merged with a copy of itself
/// which a file rounded, or which was moved and moved back.
///
/// Such a point tells nothing that its twin does not, and the distance to the nearest, in whose unit
/// surfaces, graphs and noise are measured, would be that of rounding. Thread safe: no state is kept.
#pragma once

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::pipeline {

/// Joins twins to one working point each, the first of them, where a tenth of the points or more have one:
/// two points as near as a twentieth of what it is to their eighth nearest. Fewer are so by chance, and stay.
/// Returns whether any were joined; then `of_input` and `like` say so, and neighbours have to be looked for
/// again. \param near the nearest of every point, ascending; of fewer than eight, none is a twin. O(n),
/// deterministic.
bool join_twins(const rfs_mesh::NeighborTable& near, rfs_mesh::WorkingCloud& cloud, const Context& context);

}  // namespace rfsmooth::pipeline
