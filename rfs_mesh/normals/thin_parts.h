/// Normals of thin walls, fingers and slits whose two sheets noise has merged: outward, though the points lie
/// in one sheet.
///
/// On a closed surface with right normals the winding number w (winding.h) is 1/2 at every point. Where a
/// wall or a finger is as thin as the noise was, its points end in one sheet between its two sides. Normals
/// that agree with their neighbours are then wrong on half of them, and w is off. What remains of the two
/// sides is how the points lie about their middle. With c and C the mean and the covariance of a point p and
/// its 64 nearest,
///
///     n ~ C^-1 (p - c)
///
/// points out of the wall; at its rim, or all around a finger, it points away from the middle. (It is the
/// gradient of the Gaussian density with that c and C. The plain offset turns with the uneven spacing of the
/// points.) The opposite direction points out of a slit, which is a wall seen from the solid.
///
/// Both are tried where w is off, and kept where they bring w nearer to 1/2 all around:
///
///     e_i = root mean square of w - 1/2 over the 24 nearest samples, tried above 1/4.
///
/// A surface with large openings, where w says nothing, is left alone. If e is above 1/4 at more than 3
/// samples of 10, nothing is changed unless the sum of e squared falls below 0.4 of what it was: half of a
/// shape may be merged wall, but turning the normals of an open sheet does not improve it. Thread safe: no
/// state is kept.
#pragma once

#include <cstddef>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Replaces in place those of the oriented `normals` of the points of `index` (n x 3, unit) that improve w;
/// returns how many. Walls thinner than the spacing of 50,000 samples of the cloud are not seen. O(s log s)
/// for s <= 50,000 samples where nothing is off, parallel, the same bytes for any number of threads. \throw
/// std::invalid_argument if the sizes differ.
std::size_t turn_out_of_thin_parts(const SpatialIndex& index, Positions& normals, const Context& context);

}  // namespace rfsmooth::rfs_mesh
