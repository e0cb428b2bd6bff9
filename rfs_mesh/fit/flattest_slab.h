/// How wide a neighbourhood must be for noise to be a thin slab in it.
///
/// A ball of neighbours narrower than a few sigma lies inside the slab of noisy points: it shows too little
/// of the noise, and no normal. One that is too wide takes shape for noise: what it shows then grows faster
/// than the cube root of its points, which noise never does. Thread safe: no state is kept.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include <rfsmooth/statistics.h>

#include "rfs_mesh/levels.h"

namespace rfsmooth::rfs_mesh {

/// Of neighbourhoods of `first` points and of ever twice as many, up to kWidestFit and below n, the one in
/// which sigma over the radius is least; no more are tried once that is at most kFlatSlab, or where sigma
/// grows as shape does. Asks O(log n) times. \param see called with m: what neighbourhoods of m points show;
/// its `neighbours` is 0 where no more shall be tried. \param layers sigma of points in two layers that are
/// one surface, world units: up to that, sigma may grow faster than noise does, for few points show one
/// layer.
template <class See>
NoiseScale flattest_slab(std::size_t first, std::size_t n, See&& see, double layers = 0) {
  NoiseScale best;
  double least = std::numeric_limits<double>::infinity(), before = 0;
  for (std::size_t m = first; m <= kWidestFit && m < n && least > kFlatSlab; m *= 2) {
    const NoiseScale seen = see(m);
    if (seen.neighbours == 0 || (m > first && seen.sigma > kGrowthOfNoise * std::max(before, layers))) break;
    before = seen.sigma;
    const double share = seen.radius > 0 ? seen.sigma / seen.radius : 0;
    if (!(share < least)) continue;
    least = share;
    best = seen;
  }
  return best;
}

}  // namespace rfsmooth::rfs_mesh
