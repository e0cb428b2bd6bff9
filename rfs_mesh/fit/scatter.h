/// How far the points near a place scatter about a quadric through them.
///
/// The quadric z = q . f, f = (1, u, v, u^2, u v, v^2), is fitted over the plane of least spread, with
/// weights w = (1 - t^2/r^2)^2 in the distance t along the plane. With e the residuals,
///
///     s^2 = sum w e^2 / (sum w - tr(A^-1 B)),   A = sum w f f^T,   B = sum w^2 f f^T.
///
/// Where the surface is a quadric, the expectation of s^2 is sigma^2 exactly.
///
/// Where the points lie along a line (the rings of a spinning laser), a plane through it could turn about it
/// to pass through the noise; there e is the scatter of the middle axis about a parabola, f = (1, u, u^2).
///
/// With a window, only points within 3 sigma of the quadric take part (two rounds of refitting), and s^2 is
/// divided by what the cut takes from a normal distribution: a second sheet, an edge or a stray beyond the
/// window does not count. A place where the window would cut off a quarter of the weight says nothing.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "rfs_mesh/levels.h"
#include "rfs_mesh/search/kept_neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Variance of a normal variable cut at +-c standard deviations, over its variance uncut.
double variance_inside(double c);

/// Breadth (Scatter) below which points lie along a line: rings have 0.004 to 0.04, surfaces 0.2 and more.
constexpr double kLine = 0.1;

/// Scatter::flatness and middle of a normal distribution, and flatness of an even one.
constexpr double kNormalFlatness = 3, kNormalMiddle = 0.383, kEvenFlatness = 1.8;

/// How far the points around one scatter about the quadric through them.
struct Scatter {
  double variance = 0;  ///< s^2, world units squared
  double freedom = 0;   ///< its degrees of freedom; 0: nothing can be said here
  double radius = 0;    ///< of the ball of neighbours, world units
  double together = 1;  ///< of the kRing nearest points, those above the quadric count 1, those below -1:
                        ///< the sum's square over kRing. Its mean is 1 where every point errs by itself,
                        ///< kRing where they err the same way. Without window
  /// The same along rows. Of every two of the kNeighbourhood nearest points the product of their signs, less
  /// what all have in common, as a vector in twice the angle of the direction from one to the other: the
  /// sum's square over the number of pairs. Its mean is 1 where every point errs by itself, more where those
  /// along one direction err the same way and those beside them another. Without window
  double in_rows = 1;
  /// Across the direction in which points err most alike: the mean product of the signs of two that are less
  /// than a quarter of their disk's radius apart, and of two that are that to half of it. Rows that each err
  /// by themselves are alike in themselves alone, waves are wider. Without window
  double in_row = 0, next_row = 0;
  /// Of the kNeighbourhood nearest points, the share of those beside which one lies on the other side of the
  /// quadric, so near along the patch as one would by chance beside an eighth of them; over that eighth. 1 of
  /// two sheets, and of points at random; 0 where one scan reaches from one side to the other and back from
  /// row to row, or from point to point. Without window
  double beside = 1;
  /// Fourth moment of the residuals over the square of the second: 3 of a normal distribution, 1.8 of an even
  /// one, 1 of two sheets. Without window.
  double flatness = kNormalFlatness;
  double lean = 0;  ///< third moment of the residuals squared, over the cube of the second: 0 of a
                    ///< symmetric distribution. Without window
  /// The same of every two of the patch's quadrants, multiplied with each other: without what of it is
  /// chance, so that it may be below 0. Residuals beyond those of all but a fortieth of a normal distribution
  /// count as these: grass above the ground is no lean of all. Without window.
  double lean_in_common = 0;
  /// Share of the weight within half a deviation of the quadric: 0.383 of a normal distribution, 0.289 of an
  /// even one, 0 of two sheets. Without window.
  double middle = kNormalMiddle;
  double within = 0;   ///< s^2 also where the window cuts off so much that the place says nothing; 0: too
                       ///< few points are left within it to tell
  double breadth = 0;  ///< variance of the neighbours across their longest axis over that along it, 0 to 1
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();    ///< the surface at the place
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< there; zero if the points coincide
};

/// Whether a fit has degrees of freedom enough to say anything.
template <class Fit>
bool says(const Fit& fit) {
  return fit.freedom > 0.5;
}

/// Fits one after the other, keeping its buffers. Not for several threads at once.
class ScatterFit {
 public:
  /// Fits the m points nearest to `place`; 1 <= m <= n. \param sigma world units: the window reaches
  /// kScatterWindow times as far to either side of the quadric; 0: no window. \param kept of the place.
  /// O(log n + m).
  Scatter operator()(const SpatialIndex& index, const Eigen::Vector3d& place, std::size_t m, double sigma,
                     KeptNeighbors& kept);

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  /// Of the least squares: w f f^T, w^2 f f^T (lower halves), w z f, w z^2, w and w^2.
  struct Sums {
    Matrix6 a = Matrix6::Zero(), b = Matrix6::Zero();
    Vector6 right = Vector6::Zero();
    double heights = 0, kept = 0, squares = 0;
  };

  void find_residuals(const Vector6& c);     ///< from a quadric
  void find_nearest();                       ///< sets `nearest_` and `disk_`
  double err_together() const;               ///< Scatter::together of these
  void look_at_rows(Scatter& s) const;       ///< Scatter::in_rows, in_row and next_row of these
  double lie_beside() const;                 ///< Scatter::beside of these
  void look_at_residuals(Scatter& s) const;  ///< Scatter::flatness to middle
  /// Fills `x_`, `y_` and `z_` with the points of `near_` from the place, over r.
  void scale(const Positions& points, const Eigen::Vector3d& place, double r);
  /// Axes of least to most spread of these, nearer ones weighing more. `breadth`: as in Scatter.
  Eigen::Matrix3d find_axes(double& breadth) const;
  /// Turns them: `u_` and `v_` over the radius `flat` and `z_`, along the axes from most to least spread (no
  /// v on a line). `weight_`: 1 less the square of u and v.
  void turn(const Eigen::Matrix3d& axes, double flat, bool line);
  /// Drops those of no weight, and squares the others' weights. Returns the sum.
  double keep_inside();
  /// Over the points within the window of the quadric c. \param first, last which of the rounds it is.
  /// \param sums zero
  void sum_within(double window, const Vector6& c, bool first, bool last, Sums& sums) const;

  std::vector<Neighbor> near_;
  std::vector<double> x_, y_, z_;  ///< of each point, over the ball's radius; then z_ is along the normal
  std::vector<double> u_, v_;      ///< along the patch, over its radius
  std::vector<double> weight_, residual_;
  /// Where a point lies along the patch, and on which side of the quadric, 1 or -1.
  struct Side {
    double u, v, off;
  };
  std::vector<std::pair<double, std::size_t>> by_distance_;  ///< squared, along the patch; and which point
  std::vector<Side> nearest_;  ///< the kNeighbourhood nearest, of which the kRing nearest are in front
  double disk_ = 0;            ///< squared distance of the farthest of these
};

}  // namespace rfsmooth::rfs_mesh
