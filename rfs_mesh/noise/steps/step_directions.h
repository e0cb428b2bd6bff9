/// Which way depths in steps lie (depth_steps.h), of a cloud that was turned since: registered to other
/// scans, levelled, or put upright; or of several such clouds together.
///
/// Points of one terrace lie in a plane, to all the digits that their file has, and all terraces of a camera
/// face the same way. So neighbours tell: a plane through a point and two of its nearest that holds
/// kFewestOfQuadric of them is no chance, and the direction along which most neighbours are level is that of
/// the steps, or of a grid. The columns of a camera's image lie in planes, too, but each faces another way.
#pragma once

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Unit vectors, those that more neighbours are level along first; their signs mean nothing. They may mean
/// nothing, too, of a cloud of exact planes. None if coordinates are free. \param same how far apart two
/// points on one terrace may be along its normal, world units, > 0. O(log n): looks at a thousand places.
/// Deterministic.
Positions step_directions(const SpatialIndex& index, double same);

/// Whether these are so far from parallel, 30 degrees, that rounding does not make the plane of both.
bool make_a_plane(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace rfsmooth::rfs_mesh
