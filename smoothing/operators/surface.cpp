#include "smoothing/operators/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <rfsmooth/result.h>

#include "base/parallel.h"
#include "rfs_mesh/measure.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;
using rfs_mesh::face_cross;
using rfsmooth::Face;

Vector3d unsigned_normal(const Mesh& mesh, const Adjacency& vertex_faces, Index i) {
  Vector3d largest = Vector3d::Zero(), sum = Vector3d::Zero();
  for (const Index f : vertex_faces[i]) {
    const Vector3d cross = face_cross(mesh.positions, mesh.faces[f]);
    if (cross.squaredNorm() > largest.squaredNorm()) largest = cross;
  }
  for (const Index f : vertex_faces[i]) {
    const Vector3d cross = face_cross(mesh.positions, mesh.faces[f]);
    sum += cross.dot(largest) < 0 ? Vector3d(-cross) : cross;
  }
  const double length = sum.norm();
  return length > 0 ? Vector3d(sum / length) : Vector3d(Vector3d::Zero());
}

std::vector<char> interior_vertices(const Mesh& mesh, const Adjacency& vertex_faces, const Context& context) {
  std::vector<char> interior(mesh.positions.size());
  for_each_index(context, interior.size(), [&](std::size_t i) {
    bool all = mesh.one_ring.degree(i) > 0;
    for (const Index j : mesh.one_ring[i]) {
      int faces = 0;
      for (const Index f : vertex_faces[i])
        faces += std::find(mesh.faces[f].begin(), mesh.faces[f].end(), j) != mesh.faces[f].end() ? 1 : 0;
      all = all && faces == 2;
    }
    interior[i] = all ? 1 : 0;
  });
  return interior;
}

double angle_deficit(const Mesh& mesh, const Adjacency& vertex_faces, Index i) {
  constexpr double kTwoPi = 6.283185307179586;
  double deficit = kTwoPi;
  for (const Index f : vertex_faces[i]) {
    const Face& face = mesh.faces[f];
    const int k = face[0] == i ? 0 : face[1] == i ? 1 : 2;
    const Vector3d u = mesh.positions[face[(k + 1) % 3]] - mesh.positions[i];
    const Vector3d v = mesh.positions[face[(k + 2) % 3]] - mesh.positions[i];
    deficit -= std::atan2(u.cross(v).norm(), u.dot(v));
  }
  return deficit;
}

namespace {

/// One side of a face: the edge low-high, and whether the face runs along it upward.
struct EdgeSide {
  Index low, high, face;
  bool upward;
};

/// Turns the faces so that neighbours across edges of two faces agree and parts face outward. `refuse(why)`
/// is called where the mesh is not closed, manifold at its edges and orientable; if it returns, that place is
/// left as it is.
template <class Refuse>
std::vector<Face> oriented_faces(const Mesh& mesh, Refuse&& refuse) {
  std::vector<Face> faces = mesh.faces;
  std::vector<EdgeSide> sides;
  sides.reserve(3 * faces.size());
  for (Index f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Index a = faces[f][k], b = faces[f][(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), f, a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const EdgeSide& x, const EdgeSide& y) {
    return std::tie(x.low, x.high, x.face) < std::tie(y.low, y.high, y.face);
  });
  struct Link {
    Index face;
    bool same;  ///< both run along the edge the same way, so one must turn
  };
  std::vector<std::array<Link, 3>> links(faces.size());
  std::vector<int> count(faces.size(), 0);
  for (std::size_t s = 0; s < sides.size();) {
    const EdgeSide& one = sides[s];
    std::size_t end = s + 1;
    while (end < sides.size() && sides[end].low == one.low && sides[end].high == one.high) ++end;
    if (end - s == 2) {
      const EdgeSide& two = sides[s + 1];
      const bool same = one.upward == two.upward;
      links[one.face][count[one.face]++] = {two.face, same};
      links[two.face][count[two.face]++] = {one.face, same};
    } else if (end - s > 3 && (end - s) % 2 == 0) {
      refuse(fmt::format("the edge {}-{} has more than two faces", one.low, one.high));
    } else {
      refuse(fmt::format("the edge {}-{} has an odd number of faces", one.low, one.high));
    }
    s = end;
  }
  std::vector<signed char> turn(faces.size(), -1);  // -1 unseen, 0 as it is, 1 turned
  std::vector<Index> part;
  for (Index seed = 0; seed < faces.size(); ++seed) {
    if (turn[seed] >= 0) continue;
    part.assign(1, seed);
    turn[seed] = 0;
    Vector3d centre = Vector3d::Zero();
    for (std::size_t at = 0; at < part.size(); ++at) {
      const Index f = part[at];
      for (const Index v : faces[f]) centre += mesh.positions[v] / 3;
      for (int k = 0; k < count[f]; ++k) {
        const Link& link = links[f][std::size_t(k)];
        const auto wanted = static_cast<signed char>(turn[f] ^ (link.same ? 1 : 0));
        if (turn[link.face] < 0) {
          turn[link.face] = wanted;
          part.push_back(link.face);
        } else if (turn[link.face] != wanted) {
          refuse("it has only one side");
        }
      }
    }
    centre /= double(part.size());
    double volume = 0;
    for (const Index f : part) {
      const Vector3d a = mesh.positions[faces[f][0]] - centre, b = mesh.positions[faces[f][1]] - centre,
                     c = mesh.positions[faces[f][2]] - centre;
      volume += (turn[f] != 0 ? -1 : 1) * a.dot(b.cross(c));
    }
    for (const Index f : part)
      if ((turn[f] != 0) != (volume < 0)) std::swap(faces[f][1], faces[f][2]);
  }
  return faces;
}

}  // namespace

std::vector<Face> closed_and_oriented(const Mesh& mesh, const char* what) {
  const auto refuse = [what](const std::string& why) {
    throw Failure({ErrorCode::usage, fmt::format("{} needs a closed, orientable mesh; {}", what, why)});
  };
  if (mesh.faces.empty()) refuse("this one has no faces");
  return oriented_faces(mesh, refuse);
}

std::vector<Face> oriented_as_far_as_possible(const Mesh& mesh) {
  return oriented_faces(mesh, [](const std::string&) {});
}

}  // namespace rfsmooth::smoothing
