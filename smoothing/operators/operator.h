/// Laplacian operators on a mesh as weights on a graph.
///
///     (L x)_i = (1 / m_i) sum_j w_ij (x_i - x_j),   S = M L symmetric
///
/// L is positive semi-definite and self-adjoint in the inner product <x, y> = x^T M y, M = diag(m); constants
/// are in its null space. An operator of unit 1/length^2 carries `unit` = h^2 (h = mean edge length), so that
/// time steps are dimensionless: flows use dt * unit * L. On a mesh of equilateral triangles, unit * L of the
/// scale-dependent and of the curvature operator is twice the umbrella. The functions are thread safe; an
/// OperatorSource is for one thread at a time.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <rfsmooth/flow_options.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::smoothing {

/// Symmetric weights over masses on a graph.
struct Operator {
  std::vector<double> weight;         ///< w_ij per item of rows(), symmetric; empty = all 1
  std::vector<double> mass;           ///< n: m_i > 0, also for vertices without any weight
  double unit = 1;                    ///< factor from a dimensionless step to the operator's own unit
  std::optional<Adjacency> own_rows;  ///< only if the graph is not the mesh's one-ring

  const Adjacency& rows(const Mesh& mesh) const { return own_rows ? *own_rows : mesh.one_ring; }
};

/// Where j is among the items of rows that are ascending, in row i, which has it. O(log degree).
inline Index item_of(const Adjacency& rows, std::size_t i, Index j) {
  const auto row = rows[i];
  return rows.start[i] + Index(std::lower_bound(row.begin(), row.end(), j) - row.begin());
}

/// y = L x. All arrays n rows; x and y distinct. O(edges), parallel.
void apply(const Adjacency& rows, const Operator& op, const Positions& x, Positions& y,
           const Context& context);

/// Sum of the absolute weights of each row (the degree for the umbrella). The absolute values of row i of L
/// sum to at most 2 weight_sums[i] / mass[i].
std::vector<double> weight_sums(const Adjacency& rows, const Operator& op, const Context& context);

/// Mean length of the mesh's edges, without those to closing vertices: the h of every flow, world units. 1 if
/// no edge is longer than zero.
double length_unit(const Mesh& mesh, const Context& context);

/// Umbrella, L = I - T: w = 1, m = degree. Vollmer 3.1, Ohtake (3), Desbrun (7) with the sign turned. Unit 1.
Operator umbrella(const Adjacency& rows, const Context& context);

/// Umbrella with w = 1 / |e|, m = sum of w. Ohtake (4). Edges of length zero get no weight. Unit 1.
Operator inverse_distance(const Mesh& mesh, const Context& context);

/// Scale-dependent umbrella: w = 1 / |e|, m = E/2, E = sum |e|. Desbrun (11) after Fujiwara, with the sign
/// turned; for unit edges it is twice the umbrella. Edges shorter than 1e-6 h count as 1e-6 h. Unit h^2.
Operator scale_dependent(const Mesh& mesh, const Context& context);

/// Curvature operator: L x = H n at every vertex, pointing outward on a sphere (so -L x is the inward H n).
///
///     (L x)_i = 1 / (4 A_i) sum_j (cot a_ij + cot b_ij) (x_i - x_j),   w = (cot a + cot b) / 2,  m = 2 A
///
/// Desbrun (14), Ohtake (8). Differs from the papers: they take A = the area of the whole one-ring, which
/// gives H/3 and is what Scheme::printed does; A is the mixed area of Meyer et al. 2002 and L x is H n. More
/// or fewer than two faces at an edge contribute one cotangent each; faces with twice their area below 1e-8
/// of their longest edge squared are skipped (5.4). Zero at interior vertices of any planar mesh. Unit h^2.
Operator curvature(const Mesh& mesh, const Adjacency& vertex_faces, const Context& context,
                   Scheme scheme = Scheme::safe);

/// The curvature operator without negative weights, on any mesh: intrinsic Delaunay on the tufted cover.
///
/// Every face is taken twice, front and back, and the half-edges around each edge are glued in pairs: this
/// makes a closed manifold of any mesh. Its lengths are mollified by at most 1e-5 h, and its edges flipped
/// until they are Delaunay. The weights are half the cotangents of the result. Sharp, Crane, A Laplacian for
/// Nonmanifold Triangle Meshes, 2020. On a closed Delaunay mesh it equals the curvature operator. Since no
/// weight is negative, an implicit step of first order keeps every vertex inside the bounding box, and
/// explicit steps have their full length. Unit h^2; own rows. O(n log n) typically, one thread.
Operator tufted(const Mesh& mesh, const Context& context);

/// The curvature operator with m = sum of w (Desbrun 5.5), which moves towards the weighted mean of the
/// neighbours: explicit steps up to 1 are stable while no weight is negative. Where the weights cancel or sum
/// to less than zero there is no such mean. There m is 1e-9 of the sum of |w|, and explicit flows move the
/// vertex by its own limit (operator_speed.h). Unit 1.
Operator normalised(const Adjacency& rows, Operator op, const Context& context);

/// sum_i m_i |(L x)_i|^2: the discrete thin-plate energy of an operator. Its gradient is along L (L x)
/// (Kobbelt et al. 1998, Desbrun 2.6).
double thin_plate_energy(const Adjacency& rows, const Operator& op, const Positions& x,
                         const Context& context);

/// Builds an operator of a kind, on the current positions or once for all steps.
class OperatorSource {
 public:
  /// \param frozen keep the weights of the first mesh (Desbrun 4.3, "relative to the initial mesh").
  /// \param scheme of the curvature operator.
  OperatorSource(OperatorKind kind, bool frozen, Scheme scheme = Scheme::safe);

  /// The operator on mesh's positions now (or, frozen, on those of the first call).
  const Operator& on(const Mesh& mesh, const Context& context);

  void connectivity_changed();

 private:
  OperatorKind kind_;
  bool frozen_;
  Scheme scheme_;
  bool ready_ = false;
  Adjacency faces_;
  Operator op_;
};

}  // namespace rfsmooth::smoothing
