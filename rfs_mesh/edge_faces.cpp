#include "rfs_mesh/edge_faces.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

namespace rfsmooth::rfs_mesh {

std::vector<EdgeFace> edge_faces(const std::vector<Face>& faces) {
  std::vector<EdgeFace> all;
  all.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (Index k = 0; k < 3; ++k) {
      const Index p = faces[f][k], q = faces[f][(k + 1) % 3];
      all.push_back({std::min(p, q), std::max(p, q), Index(f), k, p < q});
    }
  std::sort(all.begin(), all.end(), [](const EdgeFace& p, const EdgeFace& q) {
    return std::tie(p.a, p.b, p.face, p.corner) < std::tie(q.a, q.b, q.face, q.corner);
  });
  return all;
}

std::vector<EdgeFace> by_angle(const Mesh& mesh, const EdgeFace* first, const EdgeFace* last) {
  const Eigen::Vector3d from = mesh.positions[first->a],
                        axis = (mesh.positions[first->b] - from).normalized(), x = axis.unitOrthogonal(),
                        y = axis.cross(x);
  std::vector<std::pair<double, EdgeFace>> turn;
  for (const EdgeFace* e = first; e != last; ++e) {
    const Eigen::Vector3d out = mesh.positions[e->opposite(mesh.faces)] - from;
    turn.emplace_back(std::atan2(out.dot(y), out.dot(x)), *e);
  }
  std::stable_sort(turn.begin(), turn.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
  std::vector<EdgeFace> sorted;
  for (const auto& [angle, e] : turn) sorted.push_back(e);
  return sorted;
}

}  // namespace rfsmooth::rfs_mesh
