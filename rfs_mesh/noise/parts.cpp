#include "rfs_mesh/noise/parts.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/parallel.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise.h"
#include "rfs_mesh/noise/noise_search.h"
#include "rfs_mesh/noise/sites/noise_sites.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// By place: the radius of the ball of the nearest points, world units.
std::vector<double> radii_of_neighbourhoods(const SpatialIndex& index, const Positions& at,
                                            const Context& context) {
  std::vector<double> radii(at.size());
  for_blocks(context, at.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near;
    for (std::size_t i = begin; i < end; ++i) {
      index.nearest(at[i], int(kNeighbourhood), near);
      radii[i] = std::sqrt(near.back().squared_distance);
    }
  });
  return radii;
}

using Radius = std::vector<double>::const_iterator;

/// The median of the square.
double typical_square(Radius first, Radius last) {
  const double typical = *std::next(first, (last - first) / 2);
  return typical * typical;
}

/// Enters the bounds between these radii, which ascend.
void find_bounds(Radius first, Radius last, std::vector<double>& bounds) {
  double least = kLeastPart, bound = 0;
  Radius middle = last;
  for (Radius r = first; r != last; ++r) {
    const double at = std::sqrt(2.0) * *r;  // denser() up to r
    const auto above = [&](double other) { return !denser(at, other); };
    const Radius from = std::next(r), split = std::lower_bound(from, last, at),
                 to = std::partition_point(split, last, above);
    const std::ptrdiff_t side = std::min(split - first, last - split);
    if (side < std::ptrdiff_t(kNeighbourhood)) continue;
    const double inside = double(to - from) / double(side);
    if (!(inside < least && typical_square(first, split) < kLeastPart * typical_square(split, last)))
      continue;
    least = inside;
    bound = at;
    middle = split;
  }
  if (middle == last) return;
  find_bounds(first, middle, bounds);
  bounds.push_back(bound);
  find_bounds(middle, last, bounds);
}

/// A part's noise at places all over its points.
NoiseField at_places(const NoiseModel& noise, const Positions& points, const Context& context) {
  const Positions places = listening_places(points, kNeighbourhood);
  NoiseField field = spread_noise(noise, places, context);
  field.sites = places;
  if (field.local_spacing.empty()) field.local_spacing.assign(places.size(), noise.spacing);
  if (field.local_shared.empty()) field.local_shared.assign(places.size(), noise.shared);
  if (field.local_told.empty()) field.local_told.assign(places.size(), 0);
  return field;
}

void append(const std::vector<double>& more, std::vector<double>& all) {
  all.insert(all.end(), more.begin(), more.end());
}

/// The noise of the points around a denser part. Where it fills even the widest balls of a fit, they are
/// strays, which have no surface.
NoiseModel noise_around(const SpatialIndex& index, const Context& context) {
  NoiseModel noise = measure_noise(index, context);
  const Positions places = sample(index.points(), kPlacesOfCloud);
  if (noise.sigma < kFlatSlab * median_radius(index, places, widest_scatter(index))) return noise;
  NoiseModel none;
  none.spacing = noise.spacing;
  none.apart = noise.apart;
  return none;
}

/// The noise of a cloud of parts: at its sites that of each part, and the figures of the largest that has
/// noise. \param spacing of the cloud
NoiseModel noise_of_all(const std::vector<Statistics::Part>& parts, const std::vector<NoiseField>& fields,
                        double spacing) {
  const auto less = [](const Statistics::Part& a, const Statistics::Part& b) {
    return std::make_pair(a.own.noise->sigma > 0, *a.own.points) <
           std::make_pair(b.own.noise->sigma > 0, *b.own.points);
  };
  NoiseModel all = *std::max_element(parts.begin(), parts.end(), less)->own.noise;
  all.spacing = spacing;
  all.sites.clear();
  for (auto* values : {&all.at_sites, &all.spacing_at_sites, &all.told_at_sites, &all.shared_at_sites})
    values->clear();
  for (const NoiseField& field : fields) {
    all.sites.insert(all.sites.end(), field.sites.begin(), field.sites.end());
    append(field.local, all.at_sites);
    append(field.local_spacing, all.spacing_at_sites);
    append(field.local_told, all.told_at_sites);
    append(field.local_shared, all.shared_at_sites);
    all.shared = std::min(all.shared, field.shared);
  }
  for (double& sigma : all.at_sites) sigma = std::max(sigma, kStays * all.sigma);
  return all;
}

}  // namespace

std::vector<double> bounds_of_parts(const SpatialIndex& index, const Context& context) {
  std::vector<double> bounds;
  if (index.points().size() <= kNeighbourhood) return bounds;
  std::vector<double> radii = radii_of_neighbourhoods(index, sample(index.points(), kPlacesOfCloud), context);
  std::sort(radii.begin(), radii.end());
  find_bounds(radii.begin(), radii.end(), bounds);
  return bounds;
}

std::vector<std::vector<Index>> rows_of_parts(const SpatialIndex& index, const std::vector<double>& bounds,
                                              const Context& context) {
  const std::vector<double> radii = radii_of_neighbourhoods(index, index.points(), context);
  std::vector<std::vector<Index>> rows(bounds.size() + 1);
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const auto part = std::upper_bound(bounds.begin(), bounds.end(), radii[i]) - bounds.begin();
    rows[std::size_t(part)].push_back(Index(i));
  }
  return rows;
}

void measure_parts(const SpatialIndex& index, Statistics& whole, const Context& context) {
  const std::vector<double> bounds = bounds_of_parts(index, context);
  if (bounds.empty()) return;
  std::vector<NoiseField> fields;
  double from = 0;
  const auto rows = rows_of_parts(index, bounds, context);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Positions points = at_rows(index.points(), rows[k], context);
    Statistics own;
    own.points = points.size();
    const SpatialIndex of_part(points, context);
    own.noise = k == 0 ? measure_noise(of_part, context) : noise_around(of_part, context);
    fields.push_back(at_places(*own.noise, points, context));
    whole.parts.push_back({from, std::move(own)});
    if (k < bounds.size()) from = bounds[k];
  }
  const double spacing = mean_spacing(nearest_distances(index, context), context);
  whole.noise = noise_of_all(whole.parts, fields, spacing);
}

}  // namespace rfsmooth::rfs_mesh
