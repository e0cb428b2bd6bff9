/// Turns normals of thin walls to the sheet that their points lie on.
///
/// The side of a normal comes from its neighbours, and a point that noise left between the two sheets of a
/// wall has as many of either side. Its place says which sheet it is on. With a the normal at x, over the
/// neighbours j whose normals are parallel to it,
///
///     a.(x_j - x) = m + b.(u, v)_j + d s_j,    s_j = sign a.n_j,
///
/// is fitted: two sheets with labels given (two_sheets.h), two parallel planes apart by d from a middle that
/// is m above the point. In a wall (d > 0) a point below the middle (m > 0) belongs to the sheet whose normal
/// is -a, unless m > 2 d: then it is on neither. The planes must be distinct: the mean square of the points
/// about them must be below d^2. Thread safe: no state is kept.
#pragma once

#include <cstddef>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Turns in place those of the oriented `normals` (n x 3, unit) of `points` (n x 3) whose points lie on the
/// other sheet; returns the number of turns. `near`: n rows of at least 64 neighbours, so that each of two
/// sheets has about 30; neighbours of slightly different places, as before smoothing, will do. A point is
/// left alone unless two neighbours have the opposite normal. O(n k), far less where no two sheets are near
/// each other; parallel, the same bytes for any number of threads. \throw std::invalid_argument if the sizes
/// differ.
std::size_t turn_to_own_sheet(const Positions& points, const NeighborTable& near, Positions& normals,
                              const Context& context);

}  // namespace rfsmooth::rfs_mesh
