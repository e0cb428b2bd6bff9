/// Compact groups of neighbouring points, of about the same size, that know nothing of points far away.
///
/// The points that a thinning (thinning.h) keeps are the centres, and every point joins the one nearest to
/// it; larger groups are made of the groups of a first step in a second, and so on. This depends on distances
/// among neighbours alone: groups turn with the cloud, do not know the order of the points, and those of a
/// part of a cloud are those of the whole but for a few near the cut. Thread safe: no state is kept.
#pragma once

#include <rfsmooth/context.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The points of each group as a row, ascending. Groups of about `members` points on the mean (>= 2), with a
/// standard deviation of a third of it in one step and of half of it in several. \param points n x 3, finite.
/// \param near their nearest; a step makes groups of up to half as many. O(n log n), parallel, deterministic.
Adjacency group_around_kept(const Positions& points, const NeighborTable& near, std::size_t members,
                            const Context& context);

}  // namespace rfsmooth::rfs_mesh
