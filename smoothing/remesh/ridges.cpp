#include "smoothing/remesh/ridges.h"

#include <cmath>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "base/linear/symmetric_eigen.h"
#include "base/parallel.h"
#include "rfs_mesh/corners.h"
#include "rfs_mesh/measure.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;
using rfs_mesh::face_cross;
using rfs_mesh::vertex_normals;

namespace {

/// B of the normal curvature k(t) = t . B t in the unit direction t = (u, v) along e1 and e2 at vertex i;
/// none where its edges do not tell. Towards a neighbour at d, k is that of the circle through both, -2 n . d
/// / |d|^2, and counts with the area of the faces that hold the edge (Taubin's weights).
std::optional<Eigen::Matrix2d> curvature_tensor(const Mesh& mesh, Adjacency::Row faces, Index i,
                                                const Vector3d& normal, const Vector3d& e1,
                                                const Vector3d& e2) {
  // The unknowns are those of B with sqrt(2) times its mixed one: it does not matter how e1 and e2 are
  // turned.
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  double total = 0;
  for (const Index f : faces) {
    const double area = face_cross(mesh.positions, mesh.faces[f]).norm();
    for (const Index j : mesh.faces[f]) {
      if (j == i) continue;
      const Vector3d d = mesh.positions[j] - mesh.positions[i];
      const Eigen::Vector2d t = Eigen::Vector2d(e1.dot(d), e2.dot(d)).normalized();
      if (!(d.squaredNorm() > 0) || t == Eigen::Vector2d::Zero()) continue;
      const Vector3d row(t.x() * t.x(), std::sqrt(2.0) * t.x() * t.y(), t.y() * t.y());
      squares += area * row * row.transpose();
      right += area * -2 * normal.dot(d) / d.squaredNorm() * row;
      total += area;
    }
  }
  if (!(total > 0)) return std::nullopt;
  squares += 1e-9 * total * Eigen::Matrix3d::Identity();  // two directions leave one curvature open
  const Vector3d B = squares.ldlt().solve(right);
  if (!B.allFinite()) return std::nullopt;
  Eigen::Matrix2d tensor;
  tensor << B[0], B[1] * std::sqrt(0.5), B[1] * std::sqrt(0.5), B[2];
  return tensor;
}

}  // namespace

PrincipalCurvatures principal_curvatures(const Mesh& mesh, const Context& context) {
  const std::size_t n = mesh.positions.size();
  const Adjacency faces = vertex_faces(mesh, context);
  PrincipalCurvatures result;
  result.k1.assign(n, 0);
  result.k2.assign(n, 0);
  result.direction1.assign(n, Vector3d::Zero());
  result.direction2.assign(n, Vector3d::Zero());
  result.normal = vertex_normals(mesh, context);
  for_each_index(context, n, [&](std::size_t i) {
    const Vector3d& normal = result.normal[i];
    if (normal == Vector3d::Zero()) return;
    const Vector3d e1 = normal.unitOrthogonal(), e2 = normal.cross(e1);
    const auto tensor = curvature_tensor(mesh, faces[i], Index(i), normal, e1, e2);
    if (!tensor) return;
    const SymmetricEigen<2> eigen = symmetric_eigen(*tensor);
    const auto lift = [&](const Eigen::Vector2d& t) { return Vector3d(t.x() * e1 + t.y() * e2); };
    result.k1[i] = eigen.values[1];
    result.k2[i] = eigen.values[0];
    result.direction1[i] = lift(eigen.vectors.col(1));
    result.direction2[i] = lift(eigen.vectors.col(0));
  });
  return result;
}

std::vector<int> ridges_and_ravines(const Mesh& mesh, double least, const Context& context) {
  const std::size_t n = mesh.positions.size();
  const PrincipalCurvatures curvature = principal_curvatures(mesh, context);
  const Adjacency faces = vertex_faces(mesh, context);
  const double lowest = least / length_unit(mesh, context);
  std::vector<int> kind(n, 0);
  for_each_index(context, n, [&](std::size_t i) {
    /// Whether sign * k is a maximum at i along `direction`: the plane of it and the normal crosses the
    /// one-ring polygon ahead and behind, and at each crossing, t of the way from a to b, k is less.
    const auto peak = [&](const std::vector<double>& k, const Vector3d& direction, double sign) {
      if (!(sign * k[i] > lowest) || direction == Vector3d::Zero()) return false;
      const Vector3d side = curvature.normal[i].cross(direction);
      bool ahead = false, behind = false;
      for (const Index f : faces[i]) {
        const auto [a, b] = rfs_mesh::other_corners(mesh.faces[f], Index(i));
        const Vector3d p = mesh.positions[a] - mesh.positions[i], q = mesh.positions[b] - mesh.positions[i];
        const double sa = side.dot(p), sb = side.dot(q);
        if ((sa < 0) == (sb < 0) && sa != 0 && sb != 0) continue;
        const double t = sa == sb ? 0.5 : sa / (sa - sb);
        if (sign * k[i] <= sign * ((1 - t) * k[a] + t * k[b])) return false;
        ((1 - t) * direction.dot(p) + t * direction.dot(q) > 0 ? ahead : behind) = true;
      }
      return ahead && behind;
    };
    if (peak(curvature.k1, curvature.direction1[i], 1))
      kind[i] = 1;
    else if (peak(curvature.k2, curvature.direction2[i], -1))
      kind[i] = -1;
  });
  return kind;
}

}  // namespace rfsmooth::smoothing
