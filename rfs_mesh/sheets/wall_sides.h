/// Normals of thin walls on the side where their points lie.
///
/// A normal's side comes from its neighbours, and a point that noise left between the two sheets of a wall
/// has as many of either. Where it lies says which sheet it is on. With a its normal, over the neighbours j
/// whose normals are parallel to it,
///
///     a.(x_j - x) = m + b.(u, v)_j + d s_j,    s_j = sign a.n_j,
///
/// is fitted by weighted least squares: two parallel planes with a middle, m above the point. In a wall
/// (d > 0) a point below the middle (m > 0) belongs to the sheet whose normal is -a, unless it is farther
/// from the middle than the sheets are from each other: then it is on neither. The two planes must be plain
/// to see: the points about them by less than half as much, root mean square, as they are from the middle.
/// Thread safe: no state is kept.
#pragma once

#include <cstddef>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Turns those of the oriented `normals` (n x 3, unit) of `points` (n x 3) whose points lie on the other
/// sheet, in place; returns the number of turns. `near`: n rows of at least 64 neighbours, so that each of
/// two sheets has about 30; neighbours of slightly other places, as before smoothing, will do. A point is
/// left alone if fewer than a seventh of its neighbours have the opposite normal. O(n k), far less where no
/// two sheets are near each other; parallel, the same bytes for any number of threads. \throw
/// std::invalid_argument if the sizes differ.
std::size_t turn_to_own_sheet(const Positions& points, const NeighborTable& near, Positions& normals,
                              const Context& context);

}  // namespace rfsmooth::rfs_mesh
