/// The normal of the least-squares plane through a point and its neighbours. Its side is arbitrary. Thread
/// safe.
#pragma once

#include <rfsmooth/mesh.h>

namespace rfsmooth::rfs_mesh {

/// Unit length; any across their line, or any at all, where they span no plane. `near`: indices of the
/// neighbours, without i. O(|near|).
Eigen::Vector3d plane_normal(const Positions& points, std::size_t i, Adjacency::Row near);

}  // namespace rfsmooth::rfs_mesh
