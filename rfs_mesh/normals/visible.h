/// Which points a scanner at a known place can have seen, and at which angle. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::rfs_mesh {

/// n: the signed cosine between each normal and the ray to `viewpoint`; 0 for points hidden behind others.
/// Directions are grouped by the cells of a cube around the viewpoint, about three spacings wide at the
/// median distance. In a cell, points up to ten spacings behind the nearest count as seen. `spacing`: world
/// units, > 0. O(n), the same for any number of threads.
std::vector<double> seen_squarely(const Positions& points, const Positions& normals,
                                  const Eigen::Vector3d& viewpoint, double spacing, const Context& context);

}  // namespace rfsmooth::rfs_mesh
