/// Smooths the parts of a cloud (rfs_mesh/noise/parts.h), each as a cloud by itself: guide, patches and
/// limits are made of one noise and one spacing.
#pragma once

#include <rfsmooth/flow.h>
#include <rfsmooth/statistics.h>

#include "rfs_mesh/noise/noise.h"
#include "smoothing/automatic/automatic.h"

namespace rfsmooth::smoothing {

/// Moves mesh.positions. \param noise of the whole cloud. \param whole has parts; what they lack is entered.
/// Noise that is stated in world units is that of the whole cloud, and differs from part to part as what was
/// measured does. O(n log n), parallel, the same bits for any number of threads.
AutomaticFindings smooth_part_by_part(Mesh& mesh, const rfs_mesh::NoiseField& noise,
                                      const AutomaticOptions& options, Statistics& whole,
                                      const Context& context);

}  // namespace rfsmooth::smoothing
