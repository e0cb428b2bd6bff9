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
/// Far points are summed as one (Barnes and Hut 1986): a box of the kd-tree whose radius is under half its
/// distance counts as a point at its centroid. e is about a spacing. Const functions are thread safe.
#pragma once

#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"
#include "rfs_mesh/search/kd_tree.h"

namespace rfsmooth::rfs_mesh {

/// By so much the winding numbers at the points of a closed surface are off 1/2, their mean and root mean
/// square.
constexpr double kClosed = 0.15;

/// Evaluates w, its adjoint and its inverse over fixed points.
class Winding {
 public:
  /// \param points n x 3, kept by reference; \param softening e, world units, > 0. O(n log n).
  Winding(const Positions& points, double softening, const Context& context);

  /// w at every point, for area vectors m (n). O(n log n), parallel, the same bits for any number of threads.
  std::vector<double> numbers(const Positions& area_vectors, const Context& context) const;

  /// The adjoint: sum over j of c_j (p_i - p_j) / (4 pi (|p_i - p_j|^2 + e^2)^(3/2)) at every point p_i.
  Positions field(const std::vector<double>& charges, const Context& context) const;

  /// The smallest area vectors with w = 1/2 everywhere, after `steps` of conjugate gradients from zero.
  Positions gauss(int steps, const Context& context) const;

 private:
  struct Ball {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double count = 0, square = 0;  ///< points in it, squared radius
  };
  void enclose(KdTree::Cursor at);
  template <class Moment, class Of>
  std::vector<Moment> moments(Moment zero, Of&& of) const;
  template <class Far, class Near>
  void visit(const Eigen::Vector3d& q, std::vector<KdTree::Cursor>& open, Far&& far, Near&& near) const;

  const Positions& points_;
  double softening_square_;
  KdTree tree_;
  std::vector<Ball> balls_;  ///< of each node
};

}  // namespace rfsmooth::rfs_mesh
