/// Noise that neighbouring points share: how large it is, and over how many points it reaches.
///
/// Blotches of a depth camera, depths in steps, clumps of photogrammetry, scans that do not quite match, and
/// the rings of a spinning laser (whose neighbours lie on a line that a quadric follows wherever it goes)
/// have this in common: a small neighbourhood follows the noise and shows little of it, and the scatter s(m)
/// about a quadric through m points grows with m until the neighbourhood is wider than the noise reaches. So
/// does the scatter of a surface that a quadric does not follow, but that grows at least with the power p
/// = 1.5 of m (edges with m, smooth shape with m^3; places are judged by their calmer quarter, where edges
/// are few). What grows slower is noise: whatever sum of noise and of shape the scatter is,
///
///     S(m) = (2^p s^2(m) - s^2(2 m)) / (2^p - 1)
///
/// is at most the noise's variance, and the largest S is how much of it is sure. k is the number for which
///
///     s^2(m) = sigma^2 g(k / m)
///
/// fits best up to that m: g is what a quadric through m points leaves of noise that is the mean of
/// independent noise over the k points around each place, computed for a disk of points and the weights of
/// scatter.h. Found is such noise if its sigma is above that of the start by more than what the start is
/// unsure of.
///
/// For what smooths, a cloud with such noise is one of n / k points with noise of their own, each seen k
/// times.
#pragma once

#include "rfs_mesh/noise/noise_search.h"

namespace rfsmooth::rfs_mesh {

/// What was found.
struct SharedNoise {
  double sigma = 0;   ///< standard deviation along the normal at calm places, world units; 0: nothing found
  double points = 1;  ///< k
  std::size_t m = 0;  ///< points of a neighbourhood that is wide enough to show it
  bool stepped = false;  ///< whether a coordinate has few values, as depths of a camera do
};

/// \param places where to look, at least one. \param start of the noise that points have of their own
/// (noise_search.h). O(log n). Parallel, deterministic. \param index at least 25 points.
SharedNoise find_shared_noise(const SpatialIndex& index, const Positions& places, const NoiseStart& start,
                              const Context& context);

}  // namespace rfsmooth::rfs_mesh
