/// The faces at every edge of a mesh, as one sorted table. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/mesh.h>

#include "rfs_mesh/corners.h"

namespace rfsmooth::rfs_mesh {

/// A face at one of its edges.
struct EdgeFace {
  Index a, b;    ///< the edge, a < b (a = b only of a face with a repeated corner)
  Index face;    ///< which face
  Index corner;  ///< 0 to 2: the edge runs from this corner of the face to the next
  bool forward;  ///< the face runs from a to b

  bool same_edge(const EdgeFace& other) const { return a == other.a && b == other.b; }
  /// The corner of the face that is not on the edge.
  Index opposite(const std::vector<Face>& faces) const { return faces[face][(corner + 2) % 3]; }
};

/// The 3 m edges of m faces, ascending by (a, b, face, corner). O(m log m), one thread.
std::vector<EdgeFace> edge_faces(const std::vector<Face>& faces);

/// Calls visit(first, last) with the rows of each edge, in order of the edges.
template <class Visit>
void for_each_edge(const std::vector<EdgeFace>& all, Visit&& visit) {
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && all[last].same_edge(all[first])) ++last;
    visit(all.data() + first, all.data() + last);
  }
}

/// The rows of one edge by the angle at which the faces stand off it, counter-clockwise as seen from b, ties
/// in the order of the table.
std::vector<EdgeFace> by_angle(const Mesh& mesh, const EdgeFace* first, const EdgeFace* last);

/// 3 face + k, where corner k of `face` is `vertex`. Precondition: one of its corners is.
inline Index corner_number(const std::vector<Face>& faces, Index face, Index vertex) {
  return 3 * face + corner_of(faces[face], vertex);
}

}  // namespace rfsmooth::rfs_mesh
