/// Normals, angle deficits and orientation of a mesh, for the flows driven by curvature. Functions are thread
/// safe: they keep no state.
#pragma once

#include <vector>

#include <rfsmooth/mesh.h>

namespace rfsmooth::smoothing {

/// The faces around each vertex, sorted into fans: faces that follow one another around the vertex across
/// edges with exactly two faces. Within a fan it is always known which faces run against each other, whatever
/// the order of their corners in the file and however sharp the edges.
struct Fans {
  Adjacency faces;           ///< vertex_faces of the mesh
  std::vector<Index> fan;    ///< per item of faces: which fan of its vertex it is in, from 0
  std::vector<char> turned;  ///< per item: 1 = oriented against the first face of its fan
};

/// Reads the connectivity only. O(sum of squared numbers of faces around a vertex), parallel.
Fans fans_of(const Mesh& mesh, const Context& context);

/// n unit normals, each up to its sign. The area vectors of the faces of a fan are turned to agree and
/// summed. The sums of the fans are added, each times its cosine to the largest: this turns it to that side,
/// and at right angles, where rounding would decide the side, its weight is zero. (Of sums equal within 1e-6
/// the first is the largest.) Zero without faces or if the sum vanishes. So the order of a face's corners in
/// the file does not matter. `against`, if given: per item of fans.faces, 1 where the face is oriented
/// against the normal of that vertex; the normals of two vertices of a face are on one side if their flags
/// agree.
Positions unsigned_normals(const Mesh& mesh, const Fans& fans, const Context& context,
                           std::vector<char>* against = nullptr);

/// n: 1 where every edge at the vertex has exactly two faces. Only there the angle deficit has a meaning.
std::vector<char> interior_vertices(const Mesh& mesh, const Adjacency& vertex_faces, const Context& context);

/// The fans of a mesh and its interior vertices, kept from step to step while its connectivity stays. One
/// thread at a time.
class KnownFans {
 public:
  /// Finds them, unless they are known. A mesh of another number of vertices is another one.
  void find(const Mesh& mesh, const Context& context);
  /// To be called when the connectivity changed.
  void forget() { fans_ = {}; }

  const Fans& fans() const { return fans_; }
  const Adjacency& faces() const { return fans_.faces; }               ///< around each vertex
  bool is_interior(std::size_t i) const { return interior_[i] != 0; }  ///< by interior_vertices

 private:
  Fans fans_;
  std::vector<char> interior_;
};

/// 2 pi - sum of the angles at vertex i: Gauss curvature times mixed area at interior vertices.
double angle_deficit(const Mesh& mesh, const Adjacency& vertex_faces, Index i);

/// The faces, oriented so that neighbours agree and closed parts face outward. \throw Failure (usage), naming
/// the first offending edge, if the mesh has no face, is open, non-manifold at an edge, or not orientable;
/// `what` names what needs it.
std::vector<Face> closed_and_oriented(const Mesh& mesh, const char* what);

/// What keeps a mesh from being the boundary of a solid.
struct Unclosed {
  std::size_t rim = 0;      ///< edges with one face
  std::size_t crowded = 0;  ///< edges with more than two
  bool one_sided = false;   ///< somewhere neighbours cannot agree, as on a Moebius strip
};

/// The same for any mesh, as far as possible: neighbours agree across edges of two faces, except where the
/// mesh has only one side. Closed parts face outward; open ones keep the side that most of their faces have.
/// `found`, if given, is set to what is missing.
std::vector<Face> oriented_as_far_as_possible(const Mesh& mesh, Unclosed* found = nullptr);

}  // namespace rfsmooth::smoothing
