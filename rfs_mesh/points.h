/// The working cloud: what every stage computes on. The caller's n x 3 coordinates (any order, non-finite
/// rows, duplicates, a far-away origin) become m <= n finite, distinct points around a local origin.
///
/// The points lie along a Morton (Z-order) curve, ties by coordinates, so that neighbours in space are
/// neighbours in memory and the working cloud, hence every later result, does not depend on the order of the
/// input (bit for bit). Thread safe: no state is kept.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/mesh.h>
#include <rfsmooth/result.h>

namespace rfsmooth::rfs_mesh {

/// The working points and where the caller's rows went.
struct WorkingCloud {
  Eigen::Vector3d origin =
      Eigen::Vector3d::Zero();      ///< centre of the finite points' bounding box; world = origin + point
  Positions points;                 ///< m x 3, finite, pairwise distinct, in Morton order
  std::vector<Index> of_input;      ///< n: the working point of each input row, kNone if not finite
  std::vector<Index> multiplicity;  ///< m: how many input rows share the point (>= 1)

  std::size_t finite() const;  ///< input rows that have a working point
};

/// Builds the working cloud of an n x 3 row-major array of coordinates in world units.
/// Rows with a NaN or infinite coordinate are left out. Subtracting the origin costs nothing in precision:
/// the result is used for differences only, and results go back as displacements added to the caller's own
/// coordinates. Errors: no_usable_points if no row is finite, or if the extent is so large or small (1e100,
/// 1e-100) that squares of lengths leave the range of doubles. O(n log n), parallel, deterministic.
Result<WorkingCloud> make_working_cloud(const double* xyz, std::size_t n, const Context& context);

}  // namespace rfsmooth::rfs_mesh
