/// Filters normals without rounding edges: each becomes a mean of its neighbours' normals in which those that
/// differ much count little,
///
///     n_i <- normalised sum over j of (1 - d^2/R^2)^2 exp(-|n_i -+ n_j|^2 / (2 s_i^2)) (+-n_j),
///
/// the sign chosen so that both are on one side. Jones, Durand and Zwicker 2004, "Normal improvement for
/// point rendering"; Zheng et al. 2011, "Bilateral normal filtering for mesh denoising", local scheme. The
/// filter is needed because the noise left by smoothing turns normals by several degrees while it moves
/// points by a few percent of the spacing.
///
/// Differs from the papers: exp(-x) is (1 - x/16)^16, which ends at 16; and s_i is measured at each point. It
/// is twice the lower-middle angle to the normals of the sixteen nearest neighbours, so that flat places with
/// calm normals keep even blunt edges; but at most
///
///     230 (r / R)^2 radians,
///
/// r the mean scatter of the 24 nearest about the surface, R the distance to the last of them. Where points
/// lie well on their surfaces, normals turn because the shape does, and this bound keeps them. Thread safe:
/// no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Filters `normals` (n x 3, unit, of any side) in place over the rows of `near`; their sides stay. At least
/// 24 neighbours are sensible; 128 make the most of large flat faces. \param scatter n: how far the points
/// near each lie off the local surface, root mean square, world units (LocalSurface::residual). O(n k),
/// parallel, the same bytes for any number of threads. \throw std::invalid_argument if the sizes differ.
void bilateral_normals(const Positions& points, const NeighborTable& near, const std::vector<double>& scatter,
                       Positions& normals, const Context& context);

}  // namespace rfsmooth::rfs_mesh
