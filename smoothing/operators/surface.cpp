#include "smoothing/operators/surface.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <rfsmooth/result.h>

#include "base/parallel.h"
#include "rfs_mesh/edge_faces.h"
#include "rfs_mesh/measure.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;
using rfs_mesh::face_cross;
using rfs_mesh::other_corners;
using rfs_mesh::OtherCorners;

namespace {

/// Sorts the faces at one vertex into fans; fan and turned have one entry per face.
void sort_fans(const std::vector<OtherCorners>& corners, Index* fan, char* turned) {
  const std::size_t m = corners.size();
  /// The only other face at the edge to v, or m.
  const auto partner = [&](std::size_t k, Index v) {
    std::size_t found = m;
    int others = 0;
    for (std::size_t o = 0; o < m; ++o)
      if (o != k && (corners[o].next == v || corners[o].last == v)) {
        found = o;
        ++others;
      }
    return others == 1 ? found : m;
  };
  std::fill_n(fan, m, kNone);
  std::vector<std::size_t> walk;
  Index fans = 0;
  for (std::size_t seed = 0; seed < m; ++seed) {
    if (fan[seed] != kNone) continue;
    fan[seed] = fans;
    turned[seed] = 0;
    walk.assign(1, seed);
    for (std::size_t at = 0; at < walk.size(); ++at)
      for (const Index v : {corners[walk[at]].next, corners[walk[at]].last}) {
        const std::size_t other = partner(walk[at], v);
        if (other == m || fan[other] != kNone) continue;
        const bool agree = (corners[other].next == v) != (corners[walk[at]].next == v);
        fan[other] = fans;
        turned[other] = static_cast<char>(agree ? turned[walk[at]] : 1 - turned[walk[at]]);
        walk.push_back(other);
      }
    ++fans;
  }
}

}  // namespace

Fans fans_of(const Mesh& mesh, const Context& context) {
  Fans fans;
  fans.faces = vertex_faces(mesh, context);
  fans.fan.resize(fans.faces.items.size());
  fans.turned.resize(fans.faces.items.size());
  for_blocks(context, mesh.positions.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<OtherCorners> corners;
    for (std::size_t i = begin; i < end; ++i) {
      corners.clear();
      for (const Index f : fans.faces[i]) corners.push_back(other_corners(mesh.faces[f], Index(i)));
      const Index first = fans.faces.start[i];
      sort_fans(corners, fans.fan.data() + first, fans.turned.data() + first);
    }
  });
  return fans;
}

Positions unsigned_normals(const Mesh& mesh, const Fans& fans, const Context& context,
                           std::vector<char>* against) {
  constexpr double kRounding = 1e-6;  // far above the rounding of coordinates, far below a visible angle
  const std::size_t n = mesh.positions.size();
  Positions normals(n, Vector3d::Zero());
  if (against != nullptr) against->assign(fans.faces.items.size(), 0);
  for_blocks(context, n, 1024, [&](std::size_t begin, std::size_t end) {
    Positions sums;
    for (std::size_t i = begin; i < end; ++i) {
      sums.clear();
      double area = 0;
      for (Index k = fans.faces.start[i]; k < fans.faces.start[i + 1]; ++k) {
        const Vector3d cross = face_cross(mesh.positions, mesh.faces[fans.faces.items[k]]);
        if (fans.fan[k] >= sums.size()) sums.resize(fans.fan[k] + 1, Vector3d::Zero());
        sums[fans.fan[k]] += fans.turned[k] != 0 ? Vector3d(-cross) : cross;
        area += cross.norm();
      }
      if (sums.empty()) continue;
      Vector3d largest = sums.front();
      for (const Vector3d& s : sums)
        if (s.norm() > (1 + kRounding) * largest.norm()) largest = s;
      Vector3d sum = Vector3d::Zero();
      for (const Vector3d& s : sums)
        if (s.norm() > 0) sum += s.dot(largest) / (s.norm() * largest.norm()) * s;
      if (sum.norm() > kRounding * area) normals[i] = sum.normalized();
      if (against == nullptr) continue;
      for (Index k = fans.faces.start[i]; k < fans.faces.start[i + 1]; ++k)
        (*against)[k] =
            static_cast<char>((fans.turned[k] != 0) != (sums[fans.fan[k]].dot(largest) < 0) ? 1 : 0);
    }
  });
  return normals;
}

std::vector<char> interior_vertices(const Mesh& mesh, const Adjacency& vertex_faces, const Context& context) {
  std::vector<char> interior(mesh.positions.size());
  for_each_index(context, interior.size(), [&](std::size_t i) {
    bool all = mesh.one_ring.degree(i) > 0;
    for (const Index j : mesh.one_ring[i]) {
      int faces = 0;
      for (const Index f : vertex_faces[i]) faces += rfs_mesh::has_corner(mesh.faces[f], j) ? 1 : 0;
      all = all && faces == 2;
    }
    interior[i] = all ? 1 : 0;
  });
  return interior;
}

double angle_deficit(const Mesh& mesh, const Adjacency& vertex_faces, Index i) {
  double deficit = 2 * M_PI;
  for (const Index f : vertex_faces[i]) {
    const OtherCorners corner = other_corners(mesh.faces[f], i);
    const Vector3d u = mesh.positions[corner.next] - mesh.positions[i];
    const Vector3d v = mesh.positions[corner.last] - mesh.positions[i];
    deficit -= std::atan2(u.cross(v).norm(), u.dot(v));
  }
  return deficit;
}

namespace {

/// What is wrong at a place of a mesh that is not closed, manifold at its edges and orientable.
enum class Flaw { rim, crowded, one_sided };

/// The faces across those edges of a face that have exactly two.
struct Links {
  struct Link {
    Index face;
    bool same;  ///< both run along the edge the same way, so one must turn
  };
  std::array<Link, 3> at;
  std::size_t count = 0;

  void add(const Link& link) { at[count++] = link; }
};

/// Of every face. `refuse(flaw, why)` is called for every edge with another number of faces.
template <class Refuse>
std::vector<Links> links_of(const std::vector<Face>& faces, Refuse&& refuse) {
  std::vector<Links> links(faces.size());
  using rfs_mesh::EdgeFace;
  rfs_mesh::for_each_edge(rfs_mesh::edge_faces(faces), [&](const EdgeFace* first, const EdgeFace* last) {
    const EdgeFace &one = first[0], &two = last[-1];
    if (last - first == 2) {
      const bool same = one.forward == two.forward;
      links[one.face].add({two.face, same});
      links[two.face].add({one.face, same});
    } else if (last - first > 2) {
      refuse(Flaw::crowded, fmt::format("the edge {}-{} has more than two faces", one.a, one.b));
    } else {
      refuse(Flaw::rim, fmt::format("the edge {}-{} has only one face", one.a, one.b));
    }
  });
  return links;
}

/// The faces that links connect to `seed`, and in `turn` (per face: -1 unseen, 0 as it is, 1 turned) which of
/// them turn so that they agree with it. `refuse` is called where they cannot.
template <class Refuse>
std::vector<Index> agreeing_part(Index seed, const std::vector<Links>& links, std::vector<signed char>& turn,
                                 Refuse&& refuse) {
  std::vector<Index> part = {seed};
  turn[seed] = 0;
  for (std::size_t at = 0; at < part.size(); ++at) {
    const Index f = part[at];
    for (std::size_t k = 0; k < links[f].count; ++k) {
      const Links::Link& link = links[f].at[k];
      const auto wanted = static_cast<signed char>(turn[f] ^ (link.same ? 1 : 0));
      if (turn[link.face] < 0) {
        turn[link.face] = wanted;
        part.push_back(link.face);
      } else if (turn[link.face] != wanted) {
        refuse(Flaw::one_sided, "it has only one side");
      }
    }
  }
  return part;
}

/// Whether the part is to be on the other side than `turn` says: a closed one is not outward then, of an open
/// one most faces turn.
bool is_inside_out(const Mesh& mesh, const std::vector<Links>& links, const std::vector<Index>& part,
                   const std::vector<signed char>& turn) {
  if (std::any_of(part.begin(), part.end(), [&](Index f) { return links[f].count < 3; })) {
    const auto turned = std::count_if(part.begin(), part.end(), [&](Index f) { return turn[f] != 0; });
    return 2 * std::size_t(turned) > part.size();
  }
  Vector3d centre = Vector3d::Zero();
  for (const Index f : part)
    for (const Index v : mesh.faces[f]) centre += mesh.positions[v] / 3;
  centre /= double(part.size());
  double volume = 0;
  for (const Index f : part) {
    const auto corner = [&](std::size_t k) { return Vector3d(mesh.positions[mesh.faces[f][k]] - centre); };
    volume += (turn[f] != 0 ? -1 : 1) * corner(0).dot(corner(1).cross(corner(2)));
  }
  return volume < 0;
}

/// Turns the faces so that neighbours across edges of two faces agree: closed parts outward, open ones to the
/// side that most of their faces have. `refuse(flaw, why)` is called for every flaw; if it returns, that
/// place is left as it is.
template <class Refuse>
std::vector<Face> oriented_faces(const Mesh& mesh, Refuse&& refuse) {
  std::vector<Face> faces = mesh.faces;
  const std::vector<Links> links = links_of(faces, refuse);
  std::vector<signed char> turn(faces.size(), -1);
  for (Index seed = 0; seed < faces.size(); ++seed) {
    if (turn[seed] >= 0) continue;
    const std::vector<Index> part = agreeing_part(seed, links, turn, refuse);
    const bool others = is_inside_out(mesh, links, part, turn);
    for (const Index f : part)
      if ((turn[f] != 0) != others) std::swap(faces[f][1], faces[f][2]);
  }
  return faces;
}

}  // namespace

void KnownFans::find(const Mesh& mesh, const Context& context) {
  if (fans_.faces.size() == mesh.positions.size()) return;
  fans_ = fans_of(mesh, context);
  interior_ = interior_vertices(mesh, fans_.faces, context);
}

std::vector<Face> closed_and_oriented(const Mesh& mesh, const char* what) {
  const auto refuse = [what](Flaw, const std::string& why) {
    throw Failure({ErrorCode::usage, fmt::format("{} needs a closed, orientable mesh; {}", what, why)});
  };
  if (mesh.faces.empty()) refuse(Flaw::rim, "this one has no faces");
  return oriented_faces(mesh, refuse);
}

std::vector<Face> oriented_as_far_as_possible(const Mesh& mesh, Unclosed* found) {
  Unclosed flaws;
  std::vector<Face> faces = oriented_faces(mesh, [&](Flaw flaw, const std::string&) {
    if (flaw == Flaw::rim) ++flaws.rim;
    if (flaw == Flaw::crowded) ++flaws.crowded;
    if (flaw == Flaw::one_sided) flaws.one_sided = true;
  });
  if (found != nullptr) *found = flaws;
  return faces;
}

}  // namespace rfsmooth::smoothing
