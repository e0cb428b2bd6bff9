/// A reconstructed surface as a file that keeps the fields of the cloud's points.
#pragma once

#include <string>
#include <vector>

#include <rfsmooth/reconstruct.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::cli {

/// Every vertex gets the fields of its row of `cloud` (Reconstruction::row), its own x, y, z in the cloud's
/// types, and the surface's normal if the cloud has normals. They come to PLY as `convert` brings them:
/// arrays become lists, and fields that PLY has no type for are left out. A packed rgb or rgba field, as in
/// PCD, gets red, green, blue (and alpha) beside it, as viewers of meshes expect. Other elements are dropped.
pipeline::io::Cloud surface_file(pipeline::io::Cloud cloud, const Reconstruction& made,
                                 const Context& context);

/// The fields of the cloud's points that a surface file of that format has no room for, in words. O(fields).
std::vector<std::string> lost_in_surface(const pipeline::io::Cloud& cloud, pipeline::io::Format format,
                                         pipeline::io::Encoding encoding, const Context& context);

}  // namespace rfsmooth::cli
