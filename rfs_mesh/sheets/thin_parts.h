/// Normals of thin walls, fingers and slits whose sheets have run into each other: outward though the points
/// lie in one sheet.
///
/// On a closed surface with right normals the winding number w (winding.h) is 1/2 at every point. Where a
/// wall or a finger is as thin as the noise was, its points end in one sheet between its two sides; normals
/// that agree with their neighbours are then wrong on half of them, and w is off. What is left of the two
/// sides is how the points lie about their middle: with c and C the mean and the covariance of a point p and
/// its 64 nearest,
///
///     n ~ C^(-3/4) (p - c)
///
/// points out of the wall, and at the rim of it, or all around a finger, away from the middle. (C^-1 is the
/// gradient of the Gaussian density with that c and C; it hardly sees rims. C^0, the plain offset, turns with
/// the uneven spacing of the points.) The opposite points out of a slit, the same seen from the solid.
///
/// Both are tried where w is off, and kept where that brings w nearer to 1/2 all around:
///
///     e_i = root mean square of w - 1/2 over the 24 nearest samples, tried above 1/4.
///
/// A surface of which much is open, so that w says nothing, is left alone; where e is above 1/4 at more than
/// 3 samples of 10, all stays as it was unless the sum of e squared falls below 0.4 of what it was: half of a
/// shape may be merged wall, but an open sheet turned to and fro is no better than it was.
/// Thread safe: no state is kept.
#pragma once

#include <cstddef>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Changes those of the oriented `normals` of the points of `index` (n x 3, unit) that are better so, in
/// place; returns how many. Walls thinner than the spacing of 50,000 samples of the cloud are not told apart.
/// O(s log s) for s <= 50,000 samples where nothing is off, parallel, the same bytes for any number of
/// threads. \throw std::invalid_argument if the sizes differ.
std::size_t turn_out_of_thin_parts(const SpatialIndex& index, Positions& normals, const Context& context);

}  // namespace rfsmooth::rfs_mesh
