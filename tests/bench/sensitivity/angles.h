/// How far estimated normals are from the true ones.
#pragma once

#include <rfsmooth/normals.h>

#include "tests/bench/quality/data/measure.h"

namespace rfsmooth::bench {

/// Degrees, a wrong side included, and processor time.
struct Angles {
  double mean = 0, seconds = 0;
};

/// \param truth of each point, unit. One thread. \throw Failure if there is no usable point.
Angles angles_of_normals(const Positions& points, const NormalsOptions& options, const Positions& truth);

/// Of the true surface where it is nearest to each point.
Positions true_normals(const Truth& truth, const Positions& points);

}  // namespace rfsmooth::bench
