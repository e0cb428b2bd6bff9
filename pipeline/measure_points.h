/// What can be said of a cloud before it is connected: a quarter of the memory of `denoise` does for it,
/// so that it can be of more points than are smoothed at once.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/denoise.h>
#include <rfsmooth/statistics.h>

namespace rfsmooth::pipeline {

/// The box, reach, noise, spacing and scale of n x 3 coordinates as `denoise` would enter them with these
/// options. What options.statistics has is taken. O(n log n), about 200 bytes a point. Parallel,
/// deterministic. \throw Failure (no_usable_points).
Statistics measure_points(std::vector<double> xyz, const DenoiseOptions& options, const Context& context);

}  // namespace rfsmooth::pipeline
