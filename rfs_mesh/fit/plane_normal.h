/// The normal of the plane through a point and its neighbours, least squares; its side is arbitrary.
/// Thread safe.
#pragma once

#include <rfsmooth/mesh.h>

namespace rfsmooth::smoothing {

/// Unit; not finite where the points do not span a plane. `near`: indices of neighbours, without i.
/// O(|near|).
Eigen::Vector3d plane_normal(const Positions& points, std::size_t i, Adjacency::Row near);

}  // namespace rfsmooth::smoothing
