/// Outliers: strays and mixed pixels, points with no surface near them.
///
/// They are found on the raw cloud, before anything is connected. r_i is the distance from point i to its 8th
/// nearest neighbour. A point is an outlier if three tests agree:
///
/// 1. Isolated: r_i is more than twice the lower quartile of r over its 8 neighbours, the usual r there.
/// 2. Unknown: at most one point that is not isolated has it among its own 8 nearest. (Points of a sparse
///    region beside a dense one, at rims and at the ends of thin parts have each other as neighbours.)
/// 3. No surface near: take the plane through the 48 points around the nearest point that is not isolated,
///    or twice as many again until their ball holds the slab of noise (a radius of 5.5 sigma). The point is
///    off this plane by more than 5 standard deviations of the points about it, 5 sigma, and 1.2 times the
///    usual r. Or r_i is more than six times the usual r, wherever the plane is (beyond a rim it goes on).
///
/// Where strays are many, they are neighbours of strays. So the points that had an outlier as a neighbour get
/// new neighbours, among points that are neither outliers nor isolated, and are tested again, until no more
/// are found.
///
/// The noise, sigma, is the one that connecting and smoothing go by, too (noise.h). Before it is known, sigma
/// is zero in these tests: what the points about a place scatter by is all that stands for noise then. It is
/// measured on the points that are no outliers so far, and the tests are made anew.
///
/// A point that is not isolated, or that others know, is an outlier if it floats: r_i is more than four times
/// both the median of the cloud and what nine of the 64 nearest have (a ring of a surface), and the 24
/// nearest fill space (the least variance is more than 8 % of the sum) beyond five sigma.
///
/// No single test suffices: a point in the tail of Gaussian noise is isolated but within 5 sigma, a corner is
/// off its plane but not isolated, a sparse wall has a large r but is flat. Isolation by the neighbours'
/// density: Breunig et al. 2000 (LOF); the symmetric neighbourhood: Jin et al. 2006 (INFLO); surface
/// variation: Pauly et al. 2002; their conjunction is ours.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/statistics.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::pipeline {

/// n flags: 1 = outlier. None in clouds of fewer than 64 points. `points`: n x 3, finite, distinct; fastest
/// along a Morton curve. O(n log n), about 150 bytes a point; parallel, the same for any number of threads.
std::vector<char> find_outliers(const Positions& points, const Context& context);

/// Enters the noise of a cloud, if `whole` does not have it: of the points that are not far off for what
/// those about them scatter by. Where it measures on 64 points or more, it enters the reach, too, if that is
/// not there. `near`: rows of nearest neighbours, of any width.
void find_noise(const rfs_mesh::SpatialIndex& index, const rfs_mesh::NeighborTable& near, Statistics& whole,
                const Context& context);

/// The same with an index over the points and rows of nearest neighbours (of any width). The noise and the
/// reach of `whole` are taken if they are there, else measured and entered.
std::vector<char> find_outliers(const rfs_mesh::SpatialIndex& index, const rfs_mesh::NeighborTable& near,
                                Statistics& whole, const Context& context);

/// Moves a point onto the surface that the indexed points lie on, smooth ones: onto the plane through 16 of
/// them around the one nearest to it. False, and the point stays, if it is farther off than `most` (world
/// units), if on the plane it would be farther from all points than those 16 reach, as beyond a rim, or if
/// there are fewer than 16 points. O(log n).
bool land(const rfs_mesh::SpatialIndex& surface, double most, Eigen::Vector3d& point);

}  // namespace rfsmooth::pipeline
