/// What a file rounds coordinates to: to decimals, or to the seven digits of single precision.
#pragma once

#include <rfsmooth/mesh.h>

namespace rfsmooth::rfs_mesh {

/// How far apart two distances from a place may be that are the same, where files keep seven digits of each
/// coordinate: world units. \param points at least one.
double seven_digits(const Positions& points, const Eigen::Vector3d& from);

/// What coordinates are rounded to, world units: no two differ by less, as far as files tell them apart. Of
/// coordinates that are not rounded it is next to nothing. \param points at least one. O(n log n).
double rounding_of(const Positions& points);

}  // namespace rfsmooth::rfs_mesh
