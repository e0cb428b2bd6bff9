/// Depths in steps: a camera that measures by disparity or by time knows few depths, and its points lie on
/// terraces; a laser scanner that tells whole centimetres puts them on shells around itself.
///
/// Found where a coordinate has a tenth as many values as there are points, or else the distance from the
/// scanner has, or else some other direction (step_directions.h). Of several it is the one with the largest
/// steps: before a wall a camera knows so few depths that the columns of its image leave few values across,
/// too, other ones at every depth. Where they are the same at every depth, the points are on a grid of their
/// own, and depth has no steps. Between two steps every depth is as likely, so a surface of normal n has
/// noise of at least |n . ray| gap / sqrt(12) from them.
#pragma once

#include <optional>
#include <vector>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Standard deviation of what rounding to steps of one size adds.
double rounding_noise(double step);

/// The steps along one direction, of the distance from the scanner, or of a grid.
struct DepthSteps {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit; depth is along it
  std::optional<Eigen::Vector3d> scanner;                ///< if there, depth is the distance from it
  /// Whether they are those of a grid in space: points are off by as much along any normal.
  bool on_grid = false;
  std::vector<double> depths;  ///< ascending, at least two; of a grid none

  /// Of a point.
  double depth(const Eigen::Vector3d& at) const;

  /// Which of `depths` is nearest to a depth. O(log n).
  std::size_t nearest(double depth) const;

  /// Mean distance of the steps on both sides of the one nearest to a depth. O(log n).
  double gap(double depth) const;

  /// Standard deviation along the normal of a surface there.
  double sigma(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const;

  /// The gap in the middle of the points that were looked at.
  double typical = 0;
};

/// Looks at up to 20,000 points. Nothing where there are no steps. \param scanner where it may have stood.
std::optional<DepthSteps> find_depth_steps(const SpatialIndex& index,
                                           const std::optional<Eigen::Vector3d>& scanner);

/// The steps of a grid in space, turned any way: the quartiles of the distances to the nearest point are the
/// same. Nothing if they are not. \param nearest these distances, of some points.
std::optional<DepthSteps> find_grid(std::vector<double> nearest);

}  // namespace rfsmooth::rfs_mesh
