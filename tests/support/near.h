/// The neighbours that a height field asks for (smoothing/automatic/guide/height_field.h).
#pragma once

#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/guide/height_field.h"

namespace rfsmooth::support {

inline rfs_mesh::NeighborTable near_on(const Positions& guide) {
  return rfs_mesh::SpatialIndex(guide, {}).nearest(smoothing::HeightField::kNear, {});
}

}  // namespace rfsmooth::support
