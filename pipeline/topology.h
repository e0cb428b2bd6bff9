/// What kind of surface a triangle mesh is: its pieces, rims and handles.
///
/// Vertices count as far as faces use them. Per piece Euler's formula V - E + F = 2 - 2 g - b gives the genus
/// g from the b rims of an orientable manifold; `genus` is the sum over the pieces and means nothing where
/// edges are crowded or vertices pinched.
#pragma once

#include <cstddef>
#include <vector>

#include "rfsmooth/rfs_mesh/mesh.h"

namespace rfsmooth::pipeline {

/// How the faces of a mesh hang together.
struct Topology {
  std::size_t vertices = 0;  ///< that a face uses
  std::size_t edges = 0, faces = 0;
  std::size_t components = 0;         ///< pieces that hang together through vertices
  std::size_t boundary_edges = 0;     ///< with one face
  std::size_t boundary_loops = 0;     ///< pieces that the boundary edges make: rims and holes
  std::size_t crowded_edges = 0;      ///< with three faces or more
  std::size_t disagreeing_edges = 0;  ///< with two faces that run along it in the same direction
  std::size_t pinched_vertices = 0;   ///< whose faces make more than one fan or ring
  long genus = 0;                     ///< handles, if `manifold()`

  bool manifold() const { return crowded_edges == 0 && disagreeing_edges == 0 && pinched_vertices == 0; }
  bool closed_manifold() const { return manifold() && boundary_edges == 0 && faces > 0; }
};

/// Of faces over n vertices. Precondition: corners are distinct and < n. O(m log m), one thread.
Topology topology(std::size_t n, const std::vector<rfs_mesh::Face>& faces);

}  // namespace rfsmooth::pipeline
