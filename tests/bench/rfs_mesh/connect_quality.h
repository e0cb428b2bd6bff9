/// How good the RFS-mesh is where the surface is known.
#pragma once

#include <cstddef>
#include <vector>

#include "rfs_mesh/points.h"

namespace rfsmooth::bench {

std::vector<double> flat(const Positions& points);

/// Noise added, in Morton order as the pipeline hands points over; `source[i]` is the clean row of point i.
struct Noisy {
  Positions points;
  std::vector<std::size_t> source;
};

/// Isotropic Gaussian noise of that standard deviation per coordinate, world units.
Noisy with_noise(const Positions& clean, double sigma, unsigned seed);

/// Prints, beside the project's marks: the virtual sphere, the thin plate, proportions on clean shapes, and
/// the development shapes (tests/bench/quality/dataset.h). Spacing is sqrt(area / n) of the clean cloud on
/// the first three and the mean distance to the nearest neighbour on the last.
void connection_quality();

}  // namespace rfsmooth::bench
