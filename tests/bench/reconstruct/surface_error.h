/// How far two surfaces are from each other, both ways.
#pragma once

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::bench {

/// Squared lengths in the surfaces' units.
struct SurfaceError {
  double to_truth = 0;    ///< mean squared distance of the mesh from the truth, over the mesh's area
  double from_truth = 0;  ///< of the truth from the mesh, over the truth's area
  double both() const { return to_truth + from_truth; }
};

/// Measured at `samples` points of each surface, drawn uniformly by area with a fixed seed. Exact closest
/// points.
SurfaceError surface_error(const Mesh& mesh, const Mesh& truth, std::size_t samples, const Context& context);

}  // namespace rfsmooth::bench
