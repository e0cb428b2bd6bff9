/// Unit normals of a smoothed cloud, on one side: outward on closed shapes, towards the scanner where it is
/// known.
///
///     cloud -> working cloud -> connect (EMST, RFS-mesh) -> local quadrics -> bilateral normals ->
///     orient along the tree -> settle those that stand against all around them ->
///     without a viewpoint: turn those of merged walls and limbs outward ->
///     turn those between the sheets of a wall to the nearer one
///
/// Meant for what `denoise` gives back, and for any cloud: neighbourhoods are as wide as its noise asks.
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include <rfsmooth/context.h>
#include <rfsmooth/result.h>

namespace rfsmooth {

/// Which side the normals are on.
struct NormalsOptions {
  /// Where the scanner stood, world units: the points that it can see face it, and what they are connected to
  /// follows. Finite. Empty: closed shapes face outward, open ones away from their centre.
  std::optional<Eigen::Vector3d> viewpoint;
};

/// What was done.
struct NormalsReport {
  std::size_t points = 0;  ///< rows given
  std::size_t finite = 0;  ///< rows that got a normal
  std::size_t parts = 0;   ///< parts of the surface that were given their side each by itself
};

/// Writes a unit normal for each of n points (`xyz` n x 3, row-major, world units) into `normals` (n x 3,
/// row-major). Rows with a NaN or infinite coordinate get NaN; rows that share a position share a normal.
/// Fewer than three distinct points, or points in a line, get some unit vector across the line.
/// Same bytes for any number of threads and any order of the rows. On an error `normals` is untouched.
/// Errors: usage (a viewpoint that is not finite), no_usable_points, out_of_memory, cancelled. O(n log n).
/// Thread-safe on distinct arrays.
Result<NormalsReport> estimate_normals(const double* xyz, std::size_t n, const NormalsOptions& options,
                                       const Context& context, double* normals);

}  // namespace rfsmooth
