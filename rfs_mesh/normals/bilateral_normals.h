/// Normals made calm without rounding edges: each becomes a mean of its neighbours' normals in which those
/// that differ much count little,
///
///     n_i <- normalised sum over j of (1 - d^2/R^2)^2 exp(-|n_i -+ n_j|^2 / (2 s_i^2)) (+-n_j),
///
/// the sign so that the two are on one side. Jones, Durand and Zwicker 2004, "Normal improvement for point
/// rendering"; Zheng et al. 2011, "Bilateral normal filtering for mesh denoising", local scheme. What is left
/// of the noise after smoothing turns normals by several degrees while it moves points by a few percent of
/// the spacing.
///
/// Differs from the papers: exp(-x) is (1 - x/16)^16, which ends at 16; s_i is measured at each point, twice
/// the lower-middle angle to its sixteen nearest neighbours' normals, so that flat places with calm normals
/// keep even blunt edges; and at most
///
///     230 (r / R)^2 radians,
///
/// r the mean scatter of the points about the surface over the 24 nearest, R the distance to the last of
/// them. Normals that turn among points that lie well on their surfaces turn because the shape does, and
/// stay. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Filters `normals` (n x 3, unit, of any side) in place over the rows of `near`; at least 24 neighbours are
/// sensible, 128 make the most of large flat faces. \param scatter n: how far points lie off the local
/// surface there, root mean square, world units (LocalSurface::residual). The sides stay as they are. O(n k),
/// parallel, the same bytes for any number of threads. \throw std::invalid_argument if the sizes differ.
void bilateral_normals(const Positions& points, const NeighborTable& near, const std::vector<double>& scatter,
                       Positions& normals, const Context& context);

}  // namespace rfsmooth::rfs_mesh
