/// Corners and edges of single faces. Thread safe.
#pragma once

#include <algorithm>

#include <rfsmooth/mesh.h>

namespace rfsmooth::rfs_mesh {

/// 0 to 2: which corner of the face is v. Precondition: one of them is.
inline Index corner_of(const Face& face, Index v) {
  return face[0] == v ? 0 : face[1] == v ? 1 : 2;
}

/// Whether v is a corner of the face.
inline bool has_corner(const Face& face, Index v) {
  return face[0] == v || face[1] == v || face[2] == v;
}

/// The corner of the face that is neither a nor b. Precondition: these are its other two.
inline Index third_corner(const Face& face, Index a, Index b) {
  return face[0] ^ face[1] ^ face[2] ^ a ^ b;
}

/// The other two corners of a face at one of its vertices, in the face's order.
struct OtherCorners {
  Index next, last;
};

/// Those at v. Precondition: v is a corner.
inline OtherCorners other_corners(const Face& face, Index v) {
  const Index k = corner_of(face, v);
  return {face[(k + 1) % 3], face[(k + 2) % 3]};
}

/// The edge with these ends, the lower one first.
inline Edge edge_between(Index a, Index b) {
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace rfsmooth::rfs_mesh
