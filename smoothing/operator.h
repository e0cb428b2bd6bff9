/// Laplacian operators on a mesh as weights on a graph.
///
///     (L x)_i = (1 / m_i) sum_j w_ij (x_i - x_j),   S = M L symmetric
///
/// Positive semi-definite and self-adjoint in the inner product <x, y> = x^T M y, M = diag(m). An operator of
/// unit 1/length^2 carries `unit` = h^2 (h = mean edge length), so that time steps are dimensionless: flows
/// use dt * unit * L.
#pragma once

#include <optional>
#include <vector>

#include "rfsmooth/rfs_mesh/mesh.h"

namespace rfsmooth::smoothing {

struct Operator {
  std::vector<double> weight;  ///< w_ij per item of rows(); empty = all 1
  std::vector<double> mass;    ///< n: m_i > 0; 1 where a vertex has no weight at all
  double unit = 1;             ///< what turns a dimensionless step into the operator's own unit
  std::optional<rfs_mesh::Adjacency> own_rows;  ///< only if the graph is not the mesh's one-ring

  const rfs_mesh::Adjacency& rows(const rfs_mesh::Mesh& mesh) const {
    return own_rows ? *own_rows : mesh.one_ring;
  }
};

/// y = L x. All arrays n rows; x and y distinct. O(edges), parallel.
void apply(const rfs_mesh::Adjacency& rows, const Operator& op, const Positions& x, Positions& y,
           const Context& context);

/// The umbrella, L = I - T: w = 1, m = degree (Vollmer 3.1, Ohtake (3), Desbrun (7) with the sign turned).
Operator umbrella(const rfs_mesh::Mesh& mesh, const Context& context);

/// The umbrella with w = 1 / |e|, m = sum of w (Ohtake (4)). Edges of length zero get no weight.
Operator inverse_distance(const rfs_mesh::Mesh& mesh, const Context& context);

}  // namespace rfsmooth::smoothing
