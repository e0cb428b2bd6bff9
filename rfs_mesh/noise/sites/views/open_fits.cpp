#include "rfs_mesh/noise/sites/views/open_fits.h"

#include <cmath>

#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_search.h"

namespace rfsmooth::rfs_mesh {

double OpenFits::scatter_around(const std::vector<Neighbor>& group) const {
  return std::sqrt(quantile_of(group, kTypical, [&](const Neighbor& q) { return all[q.index].variance; }));
}

double OpenFits::radius_around(const std::vector<Neighbor>& group) const {
  return quantile_of(group, 0.5, [&](const Neighbor& q) { return all[q.index].radius; });
}

double OpenFits::rounding_around(const std::vector<Neighbor>& group) const {
  if (rounding.empty()) return 0;
  return quantile_of(group, 0.5, [&](const Neighbor& q) { return rounding[q.index]; });
}

OpenFits fit_wide(const Places& places, std::size_t points, const Context& context) {
  const Positions some = listening_places(places.at(), points);
  const std::vector<Scatter> fits = Places(places.index(), some, points, context).fits(points);
  std::vector<Scatter> all;
  for (const Index nearest : nearest_points(SpatialIndex(some, context), places.at(), context))
    all.push_back(fits[nearest]);
  return {points, std::move(all)};
}

bool planes_turn(const std::vector<Neighbor>& group, const OpenFits& fits, const OpenFits& wider) {
  const double cosine = quantile_of(group, 0.5, [&](const Neighbor& q) {
    return std::abs(fits.all[q.index].normal.dot(wider.all[q.index].normal));
  });
  return 1 - cosine * cosine > kThickSlab * kThickSlab;
}

}  // namespace rfsmooth::rfs_mesh
