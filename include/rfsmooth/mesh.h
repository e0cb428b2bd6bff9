/// The one mesh type: positions, faces, and the one-ring adjacency of every vertex. It holds the RFS-mesh
/// (which may cross and overlap itself, may be open, non-orientable and non-manifold at vertices) as well as
/// a mesh read from a file. Functions that take a const mesh are thread safe; a mesh is changed by one caller
/// at a time. They are parallel, with the same result for any number of threads, and O(n + m) for n vertices
/// and m faces or edges unless they say otherwise. \throw Failure (cancelled) if `context.stop` is set,
/// (usage) for rings or faces around vertices of 2^32 entries in all: those of 2.1 billion edges, or 1.4
/// billion faces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>

namespace rfsmooth {

/// Index of a point, vertex or face. At most 2^32 - 2 of them.
using Index = std::uint32_t;
/// No point.
inline constexpr Index kNone = std::numeric_limits<Index>::max();

/// n x 3, row i = point i; contiguous doubles.
using Positions = std::vector<Eigen::Vector3d>;

/// Three different vertices; their order is the orientation.
using Face = std::array<Index, 3>;
using Edge = std::array<Index, 2>;  ///< {a, b} with a < b

/// Compressed rows: the neighbours of i are `items[start[i]] .. items[start[i + 1]]`, ascending.
struct Adjacency {
  std::vector<Index> start;  ///< n + 1
  std::vector<Index> items;

  /// The neighbours of one vertex.
  struct Row {
    const Index* first;
    const Index* last;
    const Index* begin() const { return first; }
    const Index* end() const { return last; }
    std::size_t size() const { return std::size_t(last - first); }
    Index operator[](std::size_t k) const { return first[k]; }
  };
  std::size_t size() const { return start.empty() ? 0 : start.size() - 1; }
  Row operator[](std::size_t i) const { return {items.data() + start[i], items.data() + start[i + 1]}; }
  std::size_t degree(std::size_t i) const { return start[i + 1] - start[i]; }
};

/// Invariants (checked by `check`): every index < positions.size(); no face with a repeated corner; loose
/// edges have a < b, are sorted and distinct; one_ring is symmetric, ascending, without i itself, and is
/// exactly the edges of the faces plus the loose edges.
struct Mesh {
  Positions positions;            ///< n x 3
  std::vector<Face> faces;        ///< m x 3
  std::vector<Edge> loose_edges;  ///< edges that no face has and that still are neighbourhood (SDG edges of
                                  ///< faceless vertices)
  Adjacency one_ring;             ///< n rows; call rebuild_adjacency after changing faces or loose_edges

  /// The first of the vertices that close holes for a flow, which are the last ones of its own copy of the
  /// mesh (Boundary::virtual_vertices); kNone: there are none, as in every mesh that a user makes or is
  /// given. They are no part of the surface: their edges do not count for lengths.
  Index closing = kNone;

  std::size_t edge_count() const { return one_ring.items.size() / 2; }
};

/// Symmetric adjacency of n vertices from edges in any order (duplicates and a == b are dropped). Their ends
/// are below n. O(E log degree).
Adjacency make_adjacency(std::size_t n, const std::vector<Edge>& edges, const Context& context);

/// The edges of two graphs over the same n vertices that have no edge in common.
Adjacency joined(const Adjacency& one, const Adjacency& other, const Context& context);

/// Every edge once, ascending.
std::vector<Edge> edges_of(const Adjacency& graph, const Context& context);

/// Recomputes mesh.one_ring from faces and loose_edges, whose indices are below n.
void rebuild_adjacency(Mesh& mesh, const Context& context);

/// The faces around each vertex: rows of face indices, ascending.
Adjacency vertex_faces(const Mesh& mesh, const Context& context);

/// The same for bare faces over n vertices.
Adjacency vertex_faces(std::size_t n, const std::vector<Face>& faces, const Context& context);

/// The one-ring by those of the faces over n vertices that are `kept` (m flags); `around`: all their
/// vertex_faces. Faster than rebuild_adjacency, for who has these already.
Adjacency one_ring(const Adjacency& around, const std::vector<Face>& faces, const std::vector<char>& kept,
                   const Context& context);

/// What is wrong with the mesh's invariants, one line each; empty if nothing is. All cores.
std::vector<std::string> check(const Mesh& mesh);

}  // namespace rfsmooth
