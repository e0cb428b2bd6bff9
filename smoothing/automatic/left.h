/// What smoothing left of the noise: step 5 of automatic.h. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/noise/noise.h"
#include "smoothing/automatic/patches/height_field.h"

namespace rfsmooth::smoothing {

/// Root mean square error of the smoothed heights, world units. \param height n: as smoothed. \param own n:
/// the share of each point's noise that stays in it (MixedScales). O(n), parallel, the same bits for any
/// number of threads.
double noise_left(const HeightField& field, const std::vector<float>& height, const std::vector<float>& own,
                  const rfs_mesh::NoiseField& noise, const Context& context);

}  // namespace rfsmooth::smoothing
