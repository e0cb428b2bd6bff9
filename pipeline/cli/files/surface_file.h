/// A reconstructed surface as a file that keeps what the cloud's points had.
#pragma once

#include <rfsmooth/reconstruct.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::cli {

/// Every vertex gets the fields of its row of `cloud` (Reconstruction::row), its own x, y, z in the cloud's
/// types, and the surface's normal where the cloud has normals. A packed rgb or rgba field, as PCD has it,
/// becomes red, green, blue (and alpha), which is what viewers of meshes look for. Other elements are left
/// out.
pipeline::io::Cloud surface_file(pipeline::io::Cloud cloud, const Reconstruction& made,
                                 const Context& context);

}  // namespace rfsmooth::cli
