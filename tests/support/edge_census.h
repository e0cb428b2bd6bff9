/// How the faces of a mesh meet at its edges, counted one by one.
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include <rfsmooth/mesh.h>

#include "rfs_mesh/measure.h"

namespace rfsmooth::test {

struct EdgeCensus {
  std::size_t loose = 0;          ///< edges of the one-ring without a face
  std::size_t rim = 0;            ///< edges with one face
  std::size_t inner = 0;          ///< edges with two faces
  std::size_t crowded = 0;        ///< edges with more; an RFS-mesh has none
  std::size_t faceless = 0;       ///< vertices without a face
  double dihedral_angle_sum = 0;  ///< over the inner edges; swaps never lower it (Vollmer et al. section 7)
};

inline EdgeCensus edge_census(const Mesh& mesh) {
  std::map<std::pair<Index, Index>, std::vector<Index>> across;
  std::set<Index> with_face;
  for (const Face& f : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      across[std::minmax(f[k], f[(k + 1) % 3])].push_back(f[(k + 2) % 3]);
      with_face.insert(f[k]);
    }
  EdgeCensus census;
  census.faceless = mesh.positions.size() - with_face.size();
  census.loose = mesh.edge_count() - across.size();
  for (const auto& [edge, corners] : across) {
    ++(corners.size() == 1 ? census.rim : corners.size() == 2 ? census.inner : census.crowded);
    if (corners.size() == 2)
      census.dihedral_angle_sum +=
          rfs_mesh::dihedral_angle(mesh.positions[edge.first], mesh.positions[edge.second],
                                   mesh.positions[corners[0]], mesh.positions[corners[1]]);
  }
  return census;
}

}  // namespace rfsmooth::test
