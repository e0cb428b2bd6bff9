/// How noisy a cloud is, and how dense, measured from the cloud alone: one figure and a field over it.
///
/// Points scatter about a quadric through the m nearest (scatter.h). What stands between that and the noise:
///
/// - Edges, second sheets, strays: only points within 3 sigma of the quadric count, and sigma is found from
///   below (noise_search.h): coming from above would stop at the thickness of a wall.
/// - A ball narrower than a few sigma lies inside a thick slab and tells too little: m grows from 16 until it
///   holds a patch of 2 sigma in radius.
/// - Shape that a quadric does not follow: it grows with the neighbourhood, and is taken off.
/// - Depths in steps and noise that neighbours share: they grow, too, but stop growing (site_views.h,
///   shared_noise.h, shared_around.h).
/// - Places that are louder than the rest: their windows open until they hold the scatter (noise_sites.h).
/// - Trees and whatever has no surface: louder than the noise that others show for sure, with any plane
///   (loud_shape.h).
/// - Scans have most points where their surface is nearest: places count by their area.
///
/// The figure is that of the typical place, of those that have noise where a tenth of the cloud has. The
/// field is the mean of places that are near each other and face the same way, relative to the figure
/// (noise_field.h), and says nothing of less than 7 to 10 % (what the measurement itself scatters by): on a
/// cloud of even noise it is constant. Real scans agree with what a plane through their flat places leaves,
/// within a factor of 1.7.
#pragma once

#include <algorithm>
#include <vector>

#include <rfsmooth/statistics.h>

#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/steps/depth_steps.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Least noise of a place, as a part of the figure. Points with less than twice that are not moved. Not zero,
/// because other values are divided by it.
inline constexpr double kStays = 1e-3;

/// Whether points of so much noise stay. \param figure of the cloud.
inline bool stays(double local, double figure) {
  return local < 2 * kStays * figure;
}

/// Whether the noise is told from detail all over the cloud, however small it is.
inline bool is_told(const NoiseModel& noise) {
  const std::vector<double>& told = noise.told_at_sites;
  return !told.empty() && *std::min_element(told.begin(), told.end()) == 1;
}

/// Whether depths in steps lie farther apart along the normals than the noise reaches: layers of points, that
/// look like sheets.
inline bool is_of_steps(const NoiseModel& noise) {
  return noise.rounding > rounding_noise(noise.sigma);
}

/// How many points say as much as one: as many as share the noise, or, where 16 points are on few lines, as
/// many times 16 as are a piece of the surface.
inline double points_as_one(const NoiseModel& noise) {
  const double on_few = noise.on_lines ? 1 : double(noise.piece) / double(kNarrowestPatch);
  return std::max(noise.shared, on_few);
}

/// Whether several points say only as much as one, all over the cloud.
inline bool is_shared(const NoiseModel& noise) {
  return points_as_one(noise) > 1;
}

/// The noise of a cloud, at every point.
struct NoiseField : NoiseModel {
  std::vector<double> local;          ///< n: sigma near each point, world units
  std::vector<double> local_spacing;  ///< n: spacing_at_sites near each point; empty: `spacing` everywhere
  std::vector<double> local_shared;   ///< n: shared_at_sites near each point; empty: `shared` everywhere
  std::vector<double> local_told;     ///< n: told_at_sites near each point, 0 to 1; empty: 0 everywhere

  /// points_as_one near point i.
  double as_one_near(std::size_t i) const {
    return local_shared.empty() ? points_as_one(*this) : std::max(points_as_one(*this), local_shared[i]);
  }
  /// How far off point i is a stray, world units: farther than noise may have carried it.
  double stray_beyond(std::size_t i) const { return kStray * std::max(local[i], sigma); }
  /// n: that of each point, of so many times the noise.
  std::vector<double> strays_beyond(double times, const Context& context) const;
};

/// O(log n) after the index. Parallel, deterministic. Zero for fewer than 25 points.
NoiseModel measure_noise(const SpatialIndex& index, const Context& context);

/// The noise that `whole` has, or else that of these points, measured and entered: so whoever asks first has
/// it measured, and all others hear the same. Of a cloud of parts (parts.h) each is measured by itself, and
/// the noise of all has what each has at its sites.
const NoiseModel& known_noise(const SpatialIndex& index, Statistics& whole, const Context& context);

/// The field of a noise that was measured on these points or on a cloud that they are of: at every point the
/// mean of the sites nearest to it. O(n log n), parallel, deterministic.
NoiseField spread_noise(NoiseModel model, const Positions& points, const Context& context);

/// n: the mean distance from a point to its nearest other one around each point, world units. Zero for fewer
/// than two points. O(n log n), parallel, deterministic.
std::vector<double> measure_spacing(const SpatialIndex& index, const Context& context);

}  // namespace rfsmooth::rfs_mesh
