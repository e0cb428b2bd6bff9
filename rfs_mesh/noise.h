/// How noisy a cloud is, measured from the cloud alone: one figure and a field over it.
///
/// A quadric is fitted to the m nearest neighbours of up to 4,000 points, with weights w = (1 - d^2/r^2)^2;
/// what the points scatter about it,
///
///     s^2 = sum w e^2 / (sum w - tr(A^-1 B)),   A = sum w f f^T,  B = sum w^2 f f^T,
///
/// is the noise where the surface is a quadric over the neighbourhood (its expectation is sigma^2 exactly)
/// and more elsewhere: at edges, second sheets, strong curvature. So the figure is a low quantile of s over
/// the points, corrected for being one (Wilson and Hilferty 1931), and the field a low quantile over nearby
/// points.
///
/// m grows from 24 to 1,536. A neighbourhood narrower than a few sigma is a ball inside a thick slab: it
/// tells too little noise. One too wide takes shape for noise: its residual grows faster than the cube root
/// of m, which noise never does, and the search stops. So m is the first at which sigma is at most 0.18 of
/// the radius, else the one at which that share is least.
#pragma once

#include <vector>

#include "rfsmooth/rfs_mesh/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The noise of a cloud.
struct NoiseField {
  double sigma = 0;            ///< standard deviation along the normal, world units: a low quantile
  std::size_t neighbours = 0;  ///< m
  std::vector<double> local;   ///< n: the same near each point, world units
};

/// O(n log n) for the field, O(1) in n for the figure. Parallel, deterministic. Zero for fewer than 25
/// points.
NoiseField measure_noise(const SpatialIndex& index, const Context& context);

}  // namespace rfsmooth::rfs_mesh
