/// Clouds with known truth: points of a shape, evenly or at random, and noise on top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "clouds/shapes/shapes.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::clouds {

enum class Sampling {
  uniform,       ///< independent random points: gaps and clumps, as a Poisson process has
  poisson_disk,  ///< even: no two points much nearer than the mean spacing
};

/// n points of the surface, as dense as the shape's `density` says. Same seed, same bytes.
Positions sample(const Shape& shape, std::size_t n, std::uint64_t seed,
                 Sampling sampling = Sampling::poisson_disk);

/// n points of a triangle mesh, uniform by area or Poisson-disk.
Positions sample(const Mesh& mesh, std::size_t n, std::uint64_t seed,
                 Sampling sampling = Sampling::poisson_disk);

/// Picks n of `candidates` (give five times as many) so that they lie evenly: weighted sample elimination
/// (Yuksel 2015, "Sample Elimination for Generating Poisson Disk Sample Sets"). `density` (one per candidate,
/// in (0, 1]) may be empty. Returns ascending indices. O(N log N).
std::vector<Index> eliminate(const Positions& candidates, const std::vector<double>& density, double area,
                             std::size_t n);

/// Mean distance to the nearest other point.
double mean_spacing(const Positions& points);

/// Adds isotropic Gaussian noise with standard deviation `sigma` per coordinate.
void add_noise(Positions& points, double sigma, std::uint64_t seed);

}  // namespace rfsmooth::clouds
