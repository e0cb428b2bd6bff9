#include "rfs_mesh/noise/sites/open_fits.h"

#include "rfs_mesh/noise/noise_search.h"

namespace rfsmooth::rfs_mesh {

OpenFits fit_wide(const Places& places, std::size_t points, const Context& context) {
  const Positions some = listening_places(places.at(), points);
  const std::vector<Scatter> fits = Places(places.index(), some, points, context).fits(points);
  std::vector<Scatter> all;
  for (const Index nearest : nearest_points(SpatialIndex(some, context), places.at(), context))
    all.push_back(fits[nearest]);
  return {points, std::move(all)};
}

}  // namespace rfsmooth::rfs_mesh
