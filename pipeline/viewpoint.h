/// Where a cloud was seen from, as far as its file tells.
///
/// A PCD file's VIEWPOINT is the scanner's place; but "0 0 0 1 0 0 0" is also what writers put there that
/// know of none. It is believed if it is anything else (a rotation at the origin, too), or if the cloud is
/// organised, width x height as a camera sees it, and its grid looks as it would from there: nine in ten of
/// the little triangles between neighbours of the grid are seen from the same side. An unorganised cloud with
/// the default VIEWPOINT has none, even if a scanner did stand at its origin.
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include <rfsmooth/context.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline {

/// Whether a grid of width x height points (`xyz` row-major, rows that are not finite are holes) can be what
/// was seen from `viewpoint`. False without a triangle. O(width height), parallel.
bool seen_from(const Eigen::Vector3d& viewpoint, const double* xyz, std::size_t width, std::size_t height,
               const Context& context);

/// The viewpoint of a cloud as read from a file (see above); `xyz`: its coordinates. The quaternion is not
/// needed: points of a PCD are in world units already.
std::optional<Eigen::Vector3d> recorded_viewpoint(const io::Cloud& cloud, const double* xyz,
                                                  const Context& context);

}  // namespace rfsmooth::pipeline
