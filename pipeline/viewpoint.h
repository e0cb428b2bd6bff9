/// The viewpoint of a cloud, as far as its file tells, and one to look at it from.
///
/// A PCD file's VIEWPOINT is the scanner's place, but writers also put the default "0 0 0 1 0 0 0" there if
/// they know of none. Any other value is believed, also a rotation at the origin. The default is believed if
/// the cloud is organised (width x height, as a camera sees it) and its grid looks as it would from the
/// origin: more than nine in ten of the small triangles between neighbours in the grid are seen from the same
/// side. An unorganised cloud with the default VIEWPOINT has none, even if a scanner did stand at its origin.
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline {

/// Whether a grid of width x height points (`xyz` row-major; rows that are not finite are holes) can have
/// been seen from `viewpoint`. False without a triangle. O(width height), parallel.
bool seen_from(const Eigen::Vector3d& viewpoint, const double* xyz, std::size_t width, std::size_t height,
               const Context& context);

/// The viewpoint of a cloud read from a file; `xyz`: its coordinates. The quaternion is not needed, because
/// points of a PCD file are in world coordinates.
std::optional<Eigen::Vector3d> recorded_viewpoint(const io::Cloud& cloud, const double* xyz,
                                                  const Context& context);

/// The direction in which to look at the broad side of a cloud of at least one point from above and the
/// front, turned a little so that depth shows. Unit. O(n).
Eigen::Vector3d broadside(const Positions& points);

}  // namespace rfsmooth::pipeline
