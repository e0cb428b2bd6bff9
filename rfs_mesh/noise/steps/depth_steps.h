/// Depths in steps: a camera that measures by disparity or by time knows few depths, and its points lie on
/// terraces; a laser scanner that tells whole centimetres puts them on shells around itself.
///
/// Terraces are found where a coordinate has a tenth as many values as there are points, strays and all; or
/// else where a tenth of the points are as far from a place at which a scanner stood (scanner_places.h), all
/// at multiples of one distance, or lie level along some direction (step_directions.h), and others, as of
/// other cameras, lie free between them. Of several coordinates it is the one with the largest steps: before
/// a wall a camera knows so few depths that the columns of its image leave few values across, too, other ones
/// at every depth. Where they are the same at every depth, the points are on a grid of their own, and depth
/// has no steps; where those around a point that are on its step are in a line, they are rings of a lathe's
/// part or profiles of a line scanner. Other directions do not count whose rounding cannot be told from
/// detail. Between two steps every depth is as likely, so a surface of normal n has noise of at least
/// |n . ray| gap / sqrt(12) from them.
#pragma once

#include <optional>
#include <vector>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Standard deviation of what rounding to steps of one size adds.
double rounding_noise(double step);

/// The steps along one direction, or of the distance from a scanner.
struct Terraces {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit; depth is along it
  std::optional<Eigen::Vector3d> scanner;                ///< if there, depth is the distance from it
  std::vector<double> depths;                            ///< ascending, at least two
  double same = 0;     ///< depths that differ by no more than this are one, world units
  double typical = 0;  ///< the gap in the middle of the points on them

  /// Of a point.
  double depth(const Eigen::Vector3d& at) const;

  /// Unit: the direction along which depth grows there.
  Eigen::Vector3d ray(const Eigen::Vector3d& at) const;

  /// Which of `depths` is nearest to a depth. O(log n).
  std::size_t nearest(double depth) const;

  /// Which of them a point is on, if on any. O(log n).
  std::optional<std::size_t> step_of(const Eigen::Vector3d& at) const;

  /// Mean distance of the steps on both sides of the one nearest to a depth. O(log n).
  double gap(double depth) const;

  /// Standard deviation along the normal of a surface there.
  double sigma(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const;
};

/// The steps of a cloud: of one camera or scanner, of several that saw parts of it, or of a grid.
class DepthSteps {
 public:
  /// Those of a grid in space: points are off by as much along any normal.
  explicit DepthSteps(double grid) : typical_(grid) {}

  /// \param terraces at least one. \param index keeps a reference.
  DepthSteps(std::vector<Terraces> terraces, const SpatialIndex& index);

  bool on_grid() const { return terraces_.empty(); }
  bool on_shells() const { return !on_grid() && terraces_.front().scanner; }
  const std::vector<Terraces>& terraces() const { return terraces_; }  ///< none of a grid

  /// The gap in the middle of the points that were looked at, of the first terraces.
  double typical() const { return typical_; }

  /// Whether they are larger than another's, by more than files round.
  bool exceed(const DepthSteps& other) const;

  /// Standard deviation along the normal of a surface there: by the terraces that hold the most of the
  /// kNeighbourhood nearest points, 0 if none holds a tenth of them. O(1); O(log n) where not all points are
  /// on the same.
  double sigma(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const;

 private:
  double typical_;
  std::vector<Terraces> terraces_;
  const SpatialIndex* index_ = nullptr;  ///< null: all points are on the first
};

/// Looks at up to 20,000 points. Nothing where there are no steps.
std::optional<DepthSteps> find_depth_steps(const SpatialIndex& index);

/// The steps of a grid in space, turned any way: the quartiles of the distances to the nearest point are the
/// same. Nothing if they are not. \param nearest these distances, of some points.
std::optional<DepthSteps> find_grid(std::vector<double> nearest);

}  // namespace rfsmooth::rfs_mesh
