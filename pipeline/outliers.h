/// Outliers: strays and mixed pixels, points with no surface near them.
///
/// Found on the raw cloud, before anything is connected. With r_i the distance to the 8th nearest neighbour,
/// a point is an outlier if three tests agree:
///
/// 1. Isolated: r_i is more than twice what it is around (the lower quartile of r over those neighbours).
/// 2. Unknown: at most one point that is not isolated itself has it among its own 8 nearest. Points of a
///    sparse region beside a dense one, at rims and at the ends of thin parts know each other.
/// 3. No surface near: it lies off the plane through the 48 points (or as many as the noise needs) around the
///    nearest point that is not isolated by more than 5 standard deviations of what scatters about that
///    plane, 5 of the cloud's noise, and 1.2 times the usual r. Where the plane goes on (beyond a rim) r_i
///    must be six times the usual instead.
///
/// Strays are neighbours of strays, where they are many: so what is found is taken out and those that had it
/// as a neighbour are looked at again, until no more are found. And a point is one, whoever knows it, if it
/// floats: r_i four times the median of the cloud and the lower decile of the 64 nearest, while the 24
/// nearest fill space (the least variance more than 8 % of the sum), beyond three sigma.
///
/// None of this alone will do: a point of Gaussian noise is isolated in the tail but within 5 sigma, a corner
/// is off its plane but not isolated, a sparse wall is thin but flat. Isolation by the neighbours' density:
/// Breunig et al. 2000 (LOF); the symmetric neighbourhood: Jin et al. 2006 (INFLO); surface variation: Pauly
/// et al. 2002; their conjunction is ours.
#pragma once

#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::pipeline {

/// n flags: 1 = outlier. None in clouds of fewer than 100 points. `points`: n x 3, finite, distinct; fastest
/// along a Morton curve. O(n log n), about 120 bytes a point; parallel, the same for any number of threads.
std::vector<char> find_outliers(const Positions& points, const Context& context);

/// The same for a caller who has an index over the points already and rows of nearest neighbours (of any
/// width).
std::vector<char> find_outliers(const rfs_mesh::SpatialIndex& index, const rfs_mesh::NeighborTable& near,
                                const Context& context);

}  // namespace rfsmooth::pipeline
