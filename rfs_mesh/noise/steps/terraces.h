/// Depths in steps along one direction, or of the distance from one place: which step a point is on, and what
/// the rounding to it adds.
#pragma once

#include <optional>
#include <vector>

#include <rfsmooth/mesh.h>

namespace rfsmooth::rfs_mesh {

/// Standard deviation of what rounding to steps of one size adds.
double rounding_noise(double step);

/// The steps along one direction, or of the distance from a scanner.
struct Terraces {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit; depth is along it
  std::optional<Eigen::Vector3d> scanner;                ///< if there, depth is the distance from it
  std::vector<double> depths;                            ///< ascending, at least two
  double same = 0;     ///< depths that differ by no more than this are one, world units
  double typical = 0;  ///< the median of gap() at the points on them

  /// Of a point.
  double depth(const Eigen::Vector3d& at) const;

  /// Unit: the direction along which depth grows there.
  Eigen::Vector3d ray(const Eigen::Vector3d& at) const;

  /// Which of `depths` is nearest to a depth. O(log n).
  std::size_t nearest(double depth) const;

  /// Which of them a point is on, if on any. O(log n).
  std::optional<std::size_t> step_of(const Eigen::Vector3d& at) const;

  /// The share of points anywhere that are on one.
  double by_chance() const;

  /// Mean distance of the steps on both sides of the one nearest to a depth. O(log n).
  double gap(double depth) const;

  /// Standard deviation along the normal of a surface there.
  double sigma(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const;

  /// How wide the strip of such a surface is that lies on one step; infinite where depth is the same all over
  /// it, and for a normal of zero.
  double width(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const;
};

/// Fills in the depths at which there are few points, from the least to the largest of `some`. False if those
/// that are known are not equal steps, as ranges are that a laser tells; or if they are so near to each other
/// that most depths would be. Points on circles about an axis are on shells around a place there, too, but at
/// any distances. O(n + steps).
bool fill_in(const Positions& some, Terraces& terraces);

}  // namespace rfsmooth::rfs_mesh
