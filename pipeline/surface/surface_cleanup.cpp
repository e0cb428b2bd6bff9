#include "pipeline/surface/surface_cleanup.h"

#include <algorithm>

#include "base/parallel.h"
#include "pipeline/surface/topology.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::pipeline {

std::vector<Index> nearest_points(const Mesh& mesh, const Positions& points, const Context& context) {
  return rfs_mesh::nearest_points(rfs_mesh::SpatialIndex(points, context), mesh.positions, context);
}

void drop_specks(Mesh& mesh, std::size_t least, const Context& context) {
  DisjointSets<Index> pieces = pieces_of(mesh.positions.size(), mesh.faces);
  std::vector<std::size_t> size(mesh.positions.size(), 0);
  for (const Face& f : mesh.faces) ++size[pieces.of(f[0])];
  if (mesh.faces.empty() || *std::max_element(size.begin(), size.end()) < least) return;
  mesh.faces.erase(std::remove_if(mesh.faces.begin(), mesh.faces.end(),
                                  [&](const Face& f) { return size[pieces.of(f[0])] < least; }),
                   mesh.faces.end());
  drop_unused_vertices(mesh, context);
}

void drop_unused_vertices(Mesh& mesh, const Context& context) {
  std::vector<Index> renamed(mesh.positions.size(), kNone);
  for (const Face& f : mesh.faces)
    for (const Index v : f) renamed[v] = 0;
  Index kept = 0;
  for (std::size_t v = 0; v < renamed.size(); ++v) {
    if (renamed[v] == kNone) continue;
    mesh.positions[kept] = mesh.positions[v];
    renamed[v] = kept++;
  }
  mesh.positions.resize(kept);
  for (Face& f : mesh.faces)
    for (Index& v : f) v = renamed[v];
  mesh.loose_edges.clear();
  rebuild_adjacency(mesh, context);
}

void trim_far_faces(Mesh& mesh, const Positions& points, double length, const Context& context) {
  const std::vector<Index> nearest = nearest_points(mesh, points, context);
  std::vector<char> far(nearest.size());
  for_each_index(context, nearest.size(),
                 [&](std::size_t v) { far[v] = (mesh.positions[v] - points[nearest[v]]).norm() > length; });
  mesh.faces.erase(std::remove_if(mesh.faces.begin(), mesh.faces.end(),
                                  [&](const Face& f) { return far[f[0]] || far[f[1]] || far[f[2]]; }),
                   mesh.faces.end());
  drop_unused_vertices(mesh, context);
}

}  // namespace rfsmooth::pipeline
