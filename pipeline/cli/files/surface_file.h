/// A reconstructed surface as a file that keeps the fields of the cloud's points.
#pragma once

#include <rfsmooth/reconstruct.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::cli {

/// Every vertex gets the fields of its row of `cloud` (Reconstruction::row), its own x, y, z in the cloud's
/// types, and the surface's normal if the cloud has normals. A packed rgb or rgba field, as in PCD, becomes
/// red, green, blue (and alpha), as viewers of meshes expect. Other elements are dropped.
pipeline::io::Cloud surface_file(pipeline::io::Cloud cloud, const Reconstruction& made,
                                 const Context& context);

}  // namespace rfsmooth::cli
