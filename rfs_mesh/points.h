/// The working cloud: the points that every stage works on. The caller's n x 3 coordinates may come in any
/// order and hold non-finite rows, duplicates and a far-away origin; the m <= n working points are finite,
/// distinct and around a local origin.
///
/// They are sorted along a Morton (Z-order) curve, ties by coordinates: neighbours in space are near in
/// memory, and no later result depends on the order of the input (bit for bit). Thread safe: no state is
/// kept.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/mesh.h>
#include <rfsmooth/result.h>
#include <rfsmooth/statistics.h>

namespace rfsmooth::rfs_mesh {

/// The working points, and the one of each of the caller's rows.
struct WorkingCloud {
  Eigen::Vector3d origin =
      Eigen::Vector3d::Zero();      ///< centre of the finite points' bounding box; world = origin + point
  Statistics::Box box;              ///< of the finite points, or the larger one that was given
  Positions points;                 ///< m x 3, finite, pairwise distinct, in Morton order
  std::vector<Index> of_input;      ///< n: the working point of each input row, kNone if not finite
  std::vector<Index> multiplicity;  ///< m: how many input rows share the point (>= 1)
  std::vector<Index> like;  ///< n: the row that a twin moves like, else kNone; empty: there are no twins

  std::size_t finite() const;  ///< input rows that have a working point
};

/// The box of the finite ones of n x 3 coordinates; none if none is. O(n), parallel.
std::optional<Statistics::Box> finite_box(const double* xyz, std::size_t n, const Context& context);

/// Between these, the squares of lengths up to the side of a box are numbers.
inline constexpr double kLargestSide = 1e100, kSmallestSide = 1e-100;

/// Infinite where the side is no double.
double largest_side(const Statistics::Box& box);

/// Whether a side is between them, or 0.
bool is_in_range(double side);

/// Builds the working cloud of n x 3 row-major coordinates in world units. Rows with a NaN or infinite
/// coordinate are left out. Subtracting the origin loses no precision that matters: only differences of
/// points are used, and results return as displacements of the caller's own coordinates. Errors:
/// no_usable_points if no row is finite, or if squares of lengths leave the range of doubles (extent above
/// 1e100 or below 1e-100). \param box of a larger cloud that these points are of: its origin and order are
/// taken; usage if a point is outside. O(n log n), parallel, deterministic.
Result<WorkingCloud> make_working_cloud(const double* xyz, std::size_t n, const Context& context,
                                        const Statistics::Box* box = nullptr);

}  // namespace rfsmooth::rfs_mesh
