#include "rfs_mesh/measure.h"

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

Positions face_normals(const Mesh& mesh, const Context& context) {
  Positions normals(mesh.faces.size());
  for_each_index(context, normals.size(), [&](std::size_t f) {
    normals[f] = face_cross(mesh.positions, mesh.faces[f]).stableNormalized();
  });
  return normals;
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

double surface_area(const Mesh& mesh, const Context& context) {
  return sum_over(context, mesh.faces.size(), 0.0,
                  [&](std::size_t f) { return 0.5 * face_cross(mesh.positions, mesh.faces[f]).norm(); });
}

double signed_volume(const Mesh& mesh, const Context& context) {
  if (mesh.positions.empty()) return 0;
  const Vector3d centre = sum_over(context, mesh.positions.size(), Vector3d(Vector3d::Zero()),
                                   [&](std::size_t i) { return mesh.positions[i]; }) /
                          double(mesh.positions.size());
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

namespace {

Index opposite(const Face& f, Index a, Index b) {
  for (const Index v : f)
    if (v != a && v != b) return v;
  return kNone;
}

bool has_corner(const Face& f, Index v) {
  return f[0] == v || f[1] == v || f[2] == v;
}

}  // namespace

double dihedral_angle_sum(const Mesh& mesh, const Context& context) {
  const Adjacency around = vertex_faces(mesh, context);
  const auto& at = mesh.positions;
  return sum_over(context, mesh.one_ring.size(), 0.0, [&](std::size_t a) {
    double sum = 0;
    for (const Index b : mesh.one_ring[a]) {
      if (b < a) continue;
      Index across[2], count = 0;
      for (const Index f : around[a])
        if (has_corner(mesh.faces[f], b) && count++ < 2)
          across[count - 1] = opposite(mesh.faces[f], Index(a), b);
      if (count == 2) sum += dihedral_angle(at[a], at[b], at[across[0]], at[across[1]]);
    }
    return sum;
  });
}

EdgeCensus edge_census(const Mesh& mesh, const Context& context) {
  const Adjacency around = vertex_faces(mesh, context);
  return reduce_blocks(
      context, mesh.one_ring.size(), EdgeCensus{},
      [&](std::size_t begin, std::size_t end) {
        EdgeCensus c;
        for (std::size_t a = begin; a < end; ++a) {
          if (around.degree(a) == 0) ++c.faceless;
          for (const Index b : mesh.one_ring[a]) {
            if (b < a) continue;
            int faces = 0;
            for (const Index f : around[a]) faces += has_corner(mesh.faces[f], b);
            ++(faces == 0 ? c.loose : faces == 1 ? c.rim : faces == 2 ? c.inner : c.crowded);
          }
        }
        return c;
      },
      [](EdgeCensus a, const EdgeCensus& b) {
        a.loose += b.loose;
        a.rim += b.rim;
        a.inner += b.inner;
        a.crowded += b.crowded;
        a.faceless += b.faceless;
        return a;
      });
}

}  // namespace rfsmooth::rfs_mesh
