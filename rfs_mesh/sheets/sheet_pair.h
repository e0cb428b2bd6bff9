/// Two sheets of heights on the two sides of one middle, separated while they are fitted:
///
///     z = m(u, v) +- d(u, v) + noise,    m a quadric, d linear
///
/// A height belongs to the upper sheet with probability P = 1 / (1 + exp(-2 (z - m) d / s^2)), s^2 the
/// variance of the noise. m, d, s and P are found in turns (expectation maximisation, Dempster, Laird and
/// Rubin 1977), starting from one quadric through all heights and the variance about it. Heights are in units
/// of the measured noise. Walls make the measured noise too high, never too low, so s^2 is kept between 0.35
/// and 1. Const functions are thread safe.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace rfsmooth::rfs_mesh {

/// A height over a plane.
struct SheetPoint {
  double u, v;       ///< where, within -1 .. 1
  double height;     ///< z, standard deviations of the noise
  double estimate;   ///< the height that an earlier smoothing gave the point, same unit
  double weight;     ///< 0: not fitted to
  double upper = 0;  ///< out: P
};

/// The fit of two sheets, and whether to believe it.
class SheetPair {
 public:
  /// Fits to `points` and sets their P. O(points).
  explicit SheetPair(std::vector<SheetPoint>& points);

  double middle(const SheetPoint& p) const;  ///< m
  double apart(const SheetPoint& p) const;   ///< d >= 0 where the sheets do not cross

  /// The height of the sheet nearer to the point.
  double nearer(const SheetPoint& p) const {
    return middle(p) + (p.height < middle(p) ? -apart(p) : apart(p));
  }

  /// Whether there are two sheets so near to each other that they must be fitted together. False if
  /// - one sheet with more noise explains the heights as well (less than kNatsOfTwo worse);
  /// - more variance is left than the noise has, or the residuals' means over the cells of a 5 x 5 grid are
  ///   more than noise: the shape is a different one;
  /// - the estimates do not follow the two sheets. Sheets that show only in the scatter of the heights may be
  ///   more noise, and one place has too few points to tell (hidden_sheets.h can);
  /// - the sheets are more than 2.1 from the middle.
  bool convincing() const { return convincing_; }

  /// For a fit to some of the points of a place: whether one to all of them may still be convincing. False if
  /// these suffice to say that there is one sheet, or a shape that is not two sheets.
  bool possible() const { return possible_; }

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  void fit_one(std::vector<SheetPoint>& points);
  void fit_two(std::vector<SheetPoint>& points);
  void judge(const std::vector<SheetPoint>& points);

  Vector6 middle_ = Vector6::Zero();
  Eigen::Vector3d apart_ = Eigen::Vector3d::Zero();
  Matrix6 moments_;  ///< one quadric's normal equations,
  Vector6 heights_;  ///< and their right-hand side
  double weights_ = 0;
  double single_ = 0;    ///< variance about one quadric
  double variance_ = 1;  ///< s^2
  double left_ = 0;      ///< variance about the sheets, unbounded
  bool convincing_ = false, possible_ = true;
};

}  // namespace rfsmooth::rfs_mesh
