/// Depths in steps: a camera that measures by disparity or by time knows few depths, and its points lie on
/// terraces; a laser scanner that tells whole centimetres puts them on shells around itself.
///
/// Terraces are found where a coordinate has less than a tenth as many values as the points that are looked
/// at, strays and all. Of several coordinates it is the one with the largest steps: before a wall a camera
/// knows so few depths that the columns of its image leave few values across, too, other ones at every depth.
///
/// Or else they are found where a tenth of the points, and so many more than by chance,
///
/// - are as far from a place at which a scanner stood (scanner_places.h), all at multiples of one distance,
/// - or lie level along some direction (step_directions.h), and others, as of other cameras, lie free between
///   them.
///
/// Of these none count whose rounding cannot be told from detail.
///
/// No depths in steps are
///
/// - those of a grid of its own, which are the same at every depth; unless they are what coordinates were
///   rounded to since, as to whole millimetres, or cannot be told from detail,
/// - and lines: rings of a lathe's part or profiles of a line scanner, where those around a point that are on
///   its step are in a line.
///
/// Between two steps every depth is as likely, so a surface of normal n has noise of at least
/// |n . ray| gap / sqrt(12) from them.
#pragma once

#include <optional>
#include <vector>

#include "rfs_mesh/noise/steps/terraces.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The steps around one place.
struct LocalSteps {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  const Terraces* terraces = nullptr;  ///< null: there are none, or a grid
  double grid = 0;                     ///< distance of a grid's points, world units; 0: there is none

  /// Standard deviation along the normal of a surface.
  double sigma(const Eigen::Vector3d& normal) const {
    return terraces != nullptr ? terraces->sigma(at, normal) : rounding_noise(grid);
  }
  /// Terraces::width; 0 without terraces.
  double width(const Eigen::Vector3d& normal) const {
    return terraces != nullptr ? terraces->width(at, normal) : 0;
  }
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

  /// Terraces::typical of the first, or the grid's.
  double typical() const { return typical_; }

  /// Standard deviation of what coordinates were rounded by since: what scatters less lies within a step.
  double rounding() const { return on_grid() ? 0 : rounding_noise(terraces_.front().same); }

  /// Whether they are larger than another's, by more than files round.
  bool exceed(const DepthSteps& other) const;

  /// Those of a place: the first terraces where nine tenths of the cloud are on them (O(1)); else those that
  /// hold the most of the kNeighbourhood nearest points, none if none holds a tenth of them beyond chance
  /// (O(log n)). Not to be used after this is gone.
  LocalSteps at(const Eigen::Vector3d& place) const;

 private:
  double typical_;
  std::vector<Terraces> terraces_;
  const SpatialIndex* index_ = nullptr;  ///< null: nine tenths of the points are on the first
};

/// O(log n): looks at up to 50,000 points. Nothing where there are no steps. \param index of at least one
/// point. \param rounding of its coordinates (rounding.h): steps are larger. \param nearest the median
/// distance of points to their nearest.
std::optional<DepthSteps> find_depth_steps(const SpatialIndex& index, double rounding, double nearest);

/// The steps of a grid in space, turned any way: the quartiles of the distances to the nearest point are the
/// same. Nothing if they are not, or if rounding makes them so. \param nearest these distances, of some
/// points. \param rounding of the coordinates (rounding.h).
std::optional<DepthSteps> find_grid(std::vector<double> nearest, double rounding);

}  // namespace rfsmooth::rfs_mesh
