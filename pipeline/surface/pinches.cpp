#include "pipeline/surface/pinches.h"

#include <algorithm>
#include <vector>

#include "base/disjoint_sets.h"
#include "rfs_mesh/edge_faces.h"

namespace rfsmooth::pipeline {

namespace {

/// A surface as it comes apart. Corners of faces that stay together around a vertex are one fan; which faces
/// stay together, edges of several faces say, and each fan but the first of a vertex gets a name of its own.
class Parting {
 public:
  explicit Parting(const Mesh& mesh) : mesh_(mesh), sides_(rfs_mesh::edge_faces(mesh.faces)) {}

  /// The surface with its corners renamed, vertices from n on being copies of `copied`.
  std::vector<Face> renamed(std::vector<Index>& copied) {
    std::vector<Face> faces;
    // Two rounds are enough but for edges that depend on each other; what three leave is rare, and stays.
    for (int round = 0; round < 3; ++round) {
      faces = rename(copied);
      if (!turn_crowded(faces, copied)) break;
    }
    return faces;
  }

 private:
  /// One round: the faces with a vertex for every fan. \param copied filled anew
  std::vector<Face> rename(std::vector<Index>& copied) const {
    const std::size_t n = mesh_.positions.size();
    DisjointSets<Index> fans(3 * mesh_.faces.size());
    rfs_mesh::for_each_edge(sides_, [&](const rfs_mesh::EdgeFace* first, const rfs_mesh::EdgeFace* last) {
      for_each_pair(first, last, [&](const rfs_mesh::EdgeFace& s, const rfs_mesh::EdgeFace& t) {
        for (const Index v : {s.a, s.b})
          fans.join(rfs_mesh::corner_number(mesh_.faces, s.face, v),
                    rfs_mesh::corner_number(mesh_.faces, t.face, v));
      });
    });
    copied.clear();
    std::vector<char> used(n, 0);
    std::vector<Face> faces = mesh_.faces;
    std::vector<Index> name(3 * faces.size());  // of each fan, by its least corner
    for (Index c = 0; c < name.size(); ++c) {
      Index& v = faces[c / 3][c % 3];
      if (fans.of(c) == c) {
        name[c] = v;
        if (used[v] != 0) {
          name[c] = Index(n + copied.size());
          copied.push_back(v);
        }
        used[v] = 1;
      }
      v = name[fans.of(c)];
    }
    return faces;
  }

  /// Calls visit(side, side) for the faces that stay together at an edge.
  template <class Visit>
  void for_each_pair(const rfs_mesh::EdgeFace* first, const rfs_mesh::EdgeFace* last, Visit&& visit) const {
    if (last - first < 2) return;
    if (last - first == 2) {
      if (first[0].forward != first[1].forward) visit(first[0], first[1]);
      return;
    }
    const bool fronts = std::binary_search(fronts_.begin(), fronts_.end(), Edge{first->a, first->b});
    const std::vector<rfs_mesh::EdgeFace> turn = rfs_mesh::by_angle(mesh_, first, last);
    // Going round, the inside begins at a face that runs backward and ends at one that runs forward. Twice
    // round, because it may begin anywhere.
    const std::size_t count = turn.size();
    std::vector<char> paired(count, 0);
    std::vector<std::size_t> begun;
    for (std::size_t k = 0; k < 2 * count; ++k) {
      const std::size_t s = k < count ? k : k - count;
      if (paired[s] != 0) continue;
      if (turn[s].forward == fronts) {
        if (k < count) begun.push_back(s);
      } else if (!begun.empty()) {
        paired[s] = paired[begun.back()] = 1;
        visit(turn[begun.back()], turn[s]);
        begun.pop_back();
      }
    }
  }

  /// Edges that are crowded still take their faces the other way; whether there were any new ones.
  bool turn_crowded(const std::vector<Face>& faces, const std::vector<Index>& copied) {
    const std::size_t n = mesh_.positions.size(), before = fronts_.size();
    const auto was = [&](Index v) { return v < n ? v : copied[v - n]; };
    rfs_mesh::for_each_edge(rfs_mesh::edge_faces(faces),
                            [&](const rfs_mesh::EdgeFace* first, const rfs_mesh::EdgeFace* last) {
                              if (last - first < 3) return;
                              const Index a = was(first->a), b = was(first->b);
                              fronts_.push_back(rfs_mesh::edge_between(a, b));
                            });
    std::sort(fronts_.begin(), fronts_.end());
    fronts_.erase(std::unique(fronts_.begin(), fronts_.end()), fronts_.end());
    return fronts_.size() > before;
  }

  const Mesh& mesh_;
  std::vector<rfs_mesh::EdgeFace> sides_;
  std::vector<Edge> fronts_;  ///< ascending: crowded edges whose faces stay together front to front
};

}  // namespace

std::size_t part_pinches(Mesh& mesh, const Context& context) {
  std::vector<Index> copied;
  std::vector<Face> faces = Parting(mesh).renamed(copied);
  if (copied.empty()) return 0;
  for (const Index v : copied) mesh.positions.push_back(mesh.positions[v]);
  mesh.faces.swap(faces);
  rebuild_adjacency(mesh, context);
  return copied.size();
}

}  // namespace rfsmooth::pipeline
