/// The faces at every edge of a mesh, as one sorted table. Thread safe: no state is kept.
#pragma once

#include <algorithm>
#include <tuple>
#include <vector>

#include <rfsmooth/mesh.h>

namespace rfsmooth::rfs_mesh {

/// A face at one of its edges.
struct EdgeFace {
  Index a, b;    ///< the edge, a < b (a = b only of a face with a repeated corner)
  Index face;    ///< which face
  Index corner;  ///< 0 to 2: the edge runs from this corner of the face to the next
  bool forward;  ///< the face runs from a to b

  bool same_edge(const EdgeFace& other) const { return a == other.a && b == other.b; }
};

/// The 3 m edges of m faces, ascending by (a, b, face, corner). O(m log m), one thread.
inline std::vector<EdgeFace> edge_faces(const std::vector<Face>& faces) {
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

/// Calls visit(first, last) with the rows of each edge, in order of the edges.
template <class Visit>
void for_each_edge(const std::vector<EdgeFace>& all, Visit&& visit) {
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && all[last].same_edge(all[first])) ++last;
    visit(all.data() + first, all.data() + last);
  }
}

/// 3 face + k, where corner k of `face` is `vertex`. Precondition: one of its corners is.
inline Index corner_of(const std::vector<Face>& faces, Index face, Index vertex) {
  Index k = 0;
  while (faces[face][k] != vertex) ++k;
  return 3 * face + k;
}

}  // namespace rfsmooth::rfs_mesh
