/// Normals of a guide, to one side along it (Hoppe et al. 1992, 3.3, grown together by sides.h). Which of the
/// two sides is arbitrary. Thread safe: no state is kept.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::smoothing {

/// n: of the planes through the kNeighbourhood nearest or all of `near`, if these are fewer, unit. \param
/// near of the points, at least kRing each, all of them where there are fewer. O(n log n), parallel,
/// deterministic.
std::vector<Eigen::Vector3f> surface_normals(const Positions& points, const rfs_mesh::NeighborTable& near,
                                             const Context& context);

/// n: where the nearest points lie along a line, which has no normal of its own. The guide is thinned until
/// its points are as far apart along the lines as the lines are, and each point has the mean of the normals
/// nearest to it. \param across points that reach across to other lines (NoiseModel::piece).
/// O(n log n), parallel, deterministic.
std::vector<Eigen::Vector3f> normals_across_lines(const Positions& guide, const rfs_mesh::NeighborTable& near,
                                                  std::size_t across, const Context& context);

}  // namespace rfsmooth::smoothing
