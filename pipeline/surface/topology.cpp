#include "pipeline/surface/topology.h"

#include "rfs_mesh/edge_faces.h"

namespace rfsmooth::pipeline {

DisjointSets<Index> pieces_of(std::size_t n, const std::vector<Face>& faces) {
  DisjointSets<Index> pieces(n);
  for (const Face& f : faces) {
    pieces.join(f[0], f[1]);
    pieces.join(f[1], f[2]);
  }
  return pieces;
}

Topology topology(std::size_t n, const std::vector<Face>& faces) {
  Topology found;
  found.faces = faces.size();
  const std::vector<rfs_mesh::EdgeFace> sides = rfs_mesh::edge_faces(faces);
  DisjointSets<Index> pieces = pieces_of(n, faces), rims(n);
  std::vector<char> used(n, 0), on_rim(n, 0);
  for (const Face& f : faces)
    for (const Index v : f) used[v] = 1;
  // Two corners of a vertex belong to one fan if their faces share an edge at it.
  DisjointSets<Index> fans(3 * faces.size());
  rfs_mesh::for_each_edge(sides, [&](const rfs_mesh::EdgeFace* first, const rfs_mesh::EdgeFace* last) {
    ++found.edges;
    const auto count = last - first;
    if (count == 1) {
      ++found.boundary_edges;
      on_rim[first->a] = on_rim[first->b] = 1;
      rims.join(first->a, first->b);
    } else if (count > 2) {
      ++found.crowded_edges;
    } else if (first->forward == first[1].forward) {
      ++found.disagreeing_edges;
    }
    for (const rfs_mesh::EdgeFace* s = first + 1; s < last; ++s)
      for (const Index v : {s->a, s->b})
        fans.join(rfs_mesh::corner_number(faces, first->face, v), rfs_mesh::corner_number(faces, s->face, v));
  });
  std::vector<Index> fan_count(n, 0);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (Index k = 0; k < 3; ++k) {
      const auto corner = Index(3 * f + k);
      fan_count[faces[f][k]] += fans.of(corner) == corner;
    }
  for (Index v = 0; v < n; ++v) {
    found.vertices += used[v];
    found.pinched_vertices += fan_count[v] > 1;
    found.components += used[v] && pieces.of(v) == v;
    found.boundary_loops += on_rim[v] && rims.of(v) == v;
  }
  const long euler = long(found.vertices) - long(found.edges) + long(found.faces);
  found.genus = (2 * long(found.components) - long(found.boundary_loops) - euler) / 2;
  return found;
}

}  // namespace rfsmooth::pipeline
