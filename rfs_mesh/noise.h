/// How noisy a cloud is, and how dense, measured from the cloud alone: one figure and a field over it.
///
/// At up to 2,000 sites the points scatter about a quadric through the m nearest (scatter.h). Three things
/// stand between that and the noise, and each is answered:
///
/// - Edges, second sheets, strays: only points within 3 sigma of the quadric count. Sigma itself is what is
///   sought, so it is found from below: the window opens until what is in it is as narrow as a normal
///   distribution would be, first for the whole cloud (the calmer quarter of the sites), then around each
///   site. Coming from below stops at the noise of one sheet; coming from above would stop at the thickness.
/// - A ball narrower than a few sigma lies inside a thick slab and tells too little: m starts at 16 and grows
///   until the ball holds a patch of 2 sigma in radius with all of the window above and below it.
/// - Shape that a quadric does not follow. It grows with the neighbourhood and noise does not, so 2 m points
///   are asked too and the difference is taken off: s^2(m) = sigma^2 + b m to first order, so
///   sigma^2 = 2 s^2(m) - s^2(2 m), at most 0.6 of s^2(m) taken off.
///
/// Around a site speaks the mean of its nearest sites' fits, without those far above the typical one; where
/// most of them have nothing to say, the site takes over what its neighbours say. The field is the median of
/// nearby sites relative to the figure, and says nothing of less than 7 % (what the measurement itself
/// scatters by): on a cloud of even noise it is constant.
#pragma once

#include <vector>

#include "rfsmooth/rfs_mesh/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The noise of a cloud.
struct NoiseField {
  double sigma = 0;            ///< standard deviation along the normal, world units: typical of the cloud
  double shape = 0;            ///< part of s^2(m) taken off as shape, 0 to 0.6; above half little is sure
  std::size_t neighbours = 0;  ///< m
  std::vector<double> local;   ///< n: sigma near each point, world units
};

/// O(n log n) for the field, O(log n) for the figure. Parallel, deterministic. Zero for fewer than 25 points.
NoiseField measure_noise(const SpatialIndex& index, const Context& context);

/// n: the mean distance from a point to its nearest other one around each point, world units. Zero for fewer
/// than two points. O(n log n), parallel, deterministic.
std::vector<double> measure_spacing(const SpatialIndex& index, const Context& context);

}  // namespace rfsmooth::rfs_mesh
