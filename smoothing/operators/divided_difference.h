/// Second derivatives on a mesh by divided differences: a quadratic is fitted to each vertex's neighbours in
/// a local chart.
///
///     (X_uu, sqrt(2) X_uv, X_vv)_i = sum_j c_ij (x_j - x_i)
///     E(x) = sum_i w_i (|X_uu|^2 + 2 |X_uv|^2 + |X_vv|^2)_i,   w_i = mixed area / h^2
///
/// Kobbelt 1997, section 4. Parameters (u, v) are in units of h, the mesh's mean edge length, so E is in
/// world units squared. E does not depend on the rotation of the charts. Charts come from one set of
/// positions and stay fixed, so E is quadratic. Where the neighbours do not determine the fit (valence 3 and
/// 4, or all on one conic with the vertex), a ridge of 1e-6 picks the solution of minimum norm. Differs from
/// the paper: this ridge, and the choice of charts (below). One object per thread: products share scratch
/// memory.
#pragma once

#include <vector>

#include <rfsmooth/flow_options.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::smoothing {

/// The second derivatives at every vertex, from its neighbours.
class DividedDifferences {
 public:
  /// Makes the charts from mesh.positions. If the faces do not surround a vertex exactly once, all charts are
  /// Chart::tangent.
  DividedDifferences(const Mesh& mesh, Chart chart, const Context& context);

  /// y = A x, A the Hessian of E / 2: E(x) = x . A x.
  void apply(const Positions& x, Positions& y, const Context& context) const;

  /// A's diagonal.
  std::vector<double> diagonal(const Context& context) const;

  /// n: w_i > 0.
  const std::vector<double>& weights() const { return weight_; }

 private:
  struct Second {
    Eigen::Vector3d uu, uv, vv;
  };
  Second second(const Positions& x, std::size_t i) const;

  Adjacency rows_;
  std::vector<Eigen::Vector3d> coefficient_;  ///< c_ij per item of rows_
  std::vector<Index> reverse_;                ///< where item (i, j)'s partner (j, i) is
  std::vector<double> weight_;
  mutable std::vector<Second> scratch_;
};

}  // namespace rfsmooth::smoothing
