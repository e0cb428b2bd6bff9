/// The voxels that a cloud was thinned in, one point of each kept or made of all that were there, as most
/// tools do before a cloud is handed on.
///
/// Surfaces that cross a voxel at an angle leave points anywhere in it; those that lie along its sides, as
/// floors and walls do, leave them about the middle of the voxel or in a corner of it, one like the other. So
/// coordinates repeat with the voxel's size: around a place, | mean of e^(2 pi i x / size) | is large, as is
/// a peak of the structure factor of a crystal. Thread safe: no state is kept.
#pragma once

#include <optional>

#include <rfsmooth/context.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The size of these voxels, world units: the period, from half to twice the distance to the eighth nearest
/// and above that to the nearest, at which the spectra of the coordinates peak along two axes at once, in the
/// mean of 48 places. A surface across two voxels has points in both: two layers, nearer to each other than
/// the voxels are large, are one surface. Nothing where there are none; where points are on a grid, and no
/// nearer to each other than that (find_grid); where one of each voxel was kept at random; and where the
/// cloud was turned afterwards. O(log n). \param nearest median distance to the nearest point.
std::optional<double> voxel_size(const SpatialIndex& index, double nearest, const Context& context);

}  // namespace rfsmooth::rfs_mesh
