/// Collects triangles whose corners are given by position; equal positions become one vertex.
#pragma once

#include <array>
#include <map>
#include <utility>

#include <rfsmooth/mesh.h>

namespace rfsmooth::clouds {

class GridMesh {
 public:
  Index vertex(const Eigen::Vector3d& p) {
    // + 0.0 turns -0 into 0, which compares equal but would print differently.
    const auto [at, added] =
        index_.try_emplace({p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}, Index(mesh_.positions.size()));
    if (added) mesh_.positions.emplace_back(p + Eigen::Vector3d::Zero());
    return at->second;
  }
  void triangle(Index a, Index b, Index c, bool flip = false) {
    mesh_.faces.push_back(flip ? Face{a, c, b} : Face{a, b, c});
  }
  void quad(Index a, Index b, Index c, Index d, bool flip = false) {
    triangle(a, b, c, flip);
    triangle(a, c, d, flip);
  }
  Mesh take() {
    rfsmooth::rebuild_adjacency(mesh_, {});
    return std::move(mesh_);
  }

 private:
  std::map<std::array<double, 3>, Index> index_;
  Mesh mesh_;
};

}  // namespace rfsmooth::clouds
