#include "rfs_mesh/measure.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

using Eigen::Vector3d;

Vector3d face_cross(const Positions& at, const Face& face) {
  const Vector3d& a = at[face[0]];
  return (at[face[1]] - a).cross(at[face[2]] - a);
}

double face_quality(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double squares = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  if (!(squares > 0)) return 0;
  return 2 * std::sqrt(3.0) * (b - a).cross(c - a).norm() / squares;  // 2 sqrt(3) |cross| = 4 sqrt(3) A
}

double dihedral_angle(const Vector3d& p, const Vector3d& q, const Vector3d& r, const Vector3d& s) {
  // Normals of (p, q, r) and (q, p, s): parallel when flat. atan2 keeps full precision near 0 and pi.
  const Vector3d e = q - p, m = e.cross(r - p), n = (s - p).cross(e);
  const double cosine = m.dot(n), sine = m.cross(n).norm();
  if (cosine == 0 && sine == 0) return 0;
  return M_PI - std::atan2(sine, cosine);
}

Positions vertex_normals(const Mesh& mesh, const Context& context) {
  const Adjacency around = vertex_faces(mesh, context);
  Positions normals(mesh.positions.size());
  for_each_index(context, normals.size(), [&](std::size_t v) {
    Vector3d sum = Vector3d::Zero();
    for (const Index f : around[v]) sum += face_cross(mesh.positions, mesh.faces[f]);
    normals[v] = sum.stableNormalized();
  });
  return normals;
}

Vector3d centroid(const Positions& at, const Context& context) {
  return sum_over(context, at.size(), Vector3d(Vector3d::Zero()), [&](std::size_t i) { return at[i]; }) /
         double(std::max<std::size_t>(1, at.size()));
}

double surface_area(const Mesh& mesh, const Context& context) {
  return sum_over(context, mesh.faces.size(), 0.0,
                  [&](std::size_t f) { return 0.5 * face_cross(mesh.positions, mesh.faces[f]).norm(); });
}

double signed_volume(const Mesh& mesh, const Context& context) {
  const Vector3d centre = centroid(mesh.positions, context);
  return sum_over(context, mesh.faces.size(), 0.0,
                  [&](std::size_t f) {
                    const Face& v = mesh.faces[f];
                    return (mesh.positions[v[0]] - centre)
                        .dot((mesh.positions[v[1]] - centre).cross(mesh.positions[v[2]] - centre));
                  }) /
         6;
}

double mean_edge_length(const Mesh& mesh, const Context& context) {
  if (mesh.edge_count() == 0) return 0;
  const double twice = sum_over(context, mesh.one_ring.size(), 0.0, [&](std::size_t i) {
    double sum = 0;
    for (const Index j : mesh.one_ring[i]) sum += (mesh.positions[j] - mesh.positions[i]).norm();
    return sum;
  });
  return twice / double(mesh.one_ring.items.size());
}

}  // namespace rfsmooth::rfs_mesh
