/// What the SDG and the umbrellas are asked on in tests: points with their neighbours, normals and tree.
#pragma once

#include <utility>
#include <vector>

#include "rfs_mesh/connect/emst/emst.h"
#include "rfs_mesh/connect/sdg.h"
#include "rfs_mesh/fit/local_surface.h"

namespace rfsmooth::test {

/// Points that are taken to be without noise: shadows are the points.
struct TestGround {
  explicit TestGround(Positions given)
      : points(std::move(given)),
        index(points, {}),
        near(index.nearest(24, {})),
        surfaces(rfs_mesh::local_surfaces(points, near, {})),
        tree(rfs_mesh::emst(index, near, {})) {}

  rfs_mesh::Terrain terrain() const { return {points, surfaces, near, 0, between}; }
  rfs_mesh::Sdg sdg(const SdgOptions& options = {}) const {
    return rfs_mesh::make_sdg(terrain(), tree, options, {});
  }

  Positions points;
  rfs_mesh::SpatialIndex index;
  rfs_mesh::NeighborTable near;
  std::vector<LocalSurface> surfaces;
  std::vector<Edge> tree;
  std::vector<char> between;  ///< none, unless a test says so
};

}  // namespace rfsmooth::test
