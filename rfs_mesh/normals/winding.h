/// The winding number of oriented points. It tells the side of a normal without its neighbours.
///
/// Points p_j with area vectors m_j (area times normal) wind around q
///
///     w(q) = 1/(4 pi) sum over j of m_j . (p_j - q) / (|p_j - q|^2 + e^2)^(3/2)
///
/// times: 1 inside a closed surface with outward normals, 0 outside, 1/2 on it (Barill et al. 2018, "Fast
/// winding numbers for soups and clouds"). Conversely, the area vectors for which w is 1/2 at every point are
/// those of the closed surface through them: parametric Gauss reconstruction (Lin et al. 2022, "Surface
/// reconstruction from point clouds without normals by parametrizing the Gauss formula"). A few steps of
/// conjugate gradients towards the smallest such m give the side of nearly all points, also between thin
/// sheets that noise has mixed.
///
/// Far points are summed as one (Barnes and Hut 1986): the points of a box of the kd-tree count as one at
/// their centroid where they lie within half of its distance around it. e is about a spacing. A point itself
/// adds nothing to its own sum. Const functions are thread safe.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "rfs_mesh/search/kd_tree.h"

namespace rfsmooth::rfs_mesh {

/// As far as this the winding numbers at the points of a closed surface are from 1/2, in the mean and in root
/// mean square, with normals and areas that are estimates; beyond, the surface is open or has wrong normals.
constexpr double kClosed = 0.15;

/// e for so many points of a surface: 0.8 of the side of the square that each has of its area. Length.
double softening_of(double area, std::size_t count);

/// Evaluates w, its adjoint and its inverse over fixed points.
class Winding {
 public:
  /// \param points n x 3, kept by reference; \param softening e, world units. \throw std::invalid_argument
  /// unless e > 0. O(n log n).
  Winding(const Positions& points, double softening, const Context& context);

  /// w at every point, for the area vectors m of all (n x 3). O(n log n), parallel, the same bits for any
  /// number of threads; so are the two below.
  std::vector<double> numbers(const Positions& area_vectors, const Context& context) const;

  /// The adjoint, for a charge c of each (n): sum over j of c_j (p_i - p_j) / (4 pi (|p_i - p_j|^2 +
  /// e^2)^(3/2)) at every point p_i.
  Positions field(const std::vector<double>& charges, const Context& context) const;

  /// The smallest area vectors with w = 1/2 everywhere, after `steps` of conjugate gradients from zero.
  Positions gauss(int steps, const Context& context) const;

 private:
  /// The points below a node of the tree.
  struct Ball {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< their centroid
    double count = 0;                                  ///< how many
    double radius_square = 0;                          ///< of a ball around the centroid that holds their box
  };
  /// Fills in the ball of a node, those below it being there.
  void enclose(const KdTree::Cursor& at);
  /// By node: the sum over the points below it.
  template <class Moment>
  std::vector<Moment> sum_up(const std::vector<Moment>& of, Moment zero, const Context& context) const;
  /// At every point the sum of `term(r, 1 / (|r|^2 + e^2)^(3/2), moment)` / (4 pi) over all that counts as
  /// one point at r from it: points, each with its moment in `of`, and boxes far away with the sum of theirs.
  template <class Sum, class Moment, class Term>
  std::vector<Sum> evaluate(const std::vector<Moment>& of, Moment no_moment, Sum nothing,
                            const Context& context, Term&& term) const;

  const Positions& points_;
  double softening_square_;
  KdTree tree_;
  std::vector<Ball> balls_;  ///< of each node
};

}  // namespace rfsmooth::rfs_mesh
