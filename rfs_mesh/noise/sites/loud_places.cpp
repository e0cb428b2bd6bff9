#include "rfs_mesh/noise/sites/loud_places.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/sites/views/fits_around.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr std::size_t kWidest = 4 * kNeighbourhood;              // points of a fit
constexpr std::size_t kPointsAPlace = kWidest / kSmallestGroup;  // a dozen places have as many

/// By site, whether it or one of the dozen nearest is much louder by itself than was found around it; empty:
/// none is.
std::vector<char> are_near_loud_ones(const SpatialIndex& index, const NoiseSites& sites,
                                     const std::vector<double>& at_sites, const Context& context) {
  std::vector<char> loud(at_sites.size());
  for (std::size_t s = 0; s < loud.size(); ++s)
    loud[s] = char(sites.two_sheets[s] == 0 && sites.open[s] > kLouder * at_sites[s]);
  if (std::find(loud.begin(), loud.end(), 1) == loud.end()) return {};
  const SiteGroups groups = site_groups(index, kSmallestGroup, context);
  std::vector<char> near(loud.size());
  for (std::size_t s = 0; s < near.size(); ++s)
    near[s] = char(std::any_of(groups[s].begin(), groups[s].end(),
                               [&](const Neighbor& q) { return loud[q.index] != 0; }));
  return near;
}

/// The noise that points around a place have of their own, as the first fits show it whose balls hold the
/// slab; 0: none is seen for sure. \param sparsest of strays; as NoiseSites::per_root
double plain_noise(const std::vector<Neighbor>& group, const std::vector<OpenFits>& open, double sparsest) {
  for (std::size_t k = 0; k + 1 < open.size(); ++k) {
    const FitsAround here(group, open[k]), next(group, open[k + 1]);
    if (!here.holds_slab()) continue;
    const bool plain = here.radius < sparsest * std::sqrt(here.points) && here.scatter > 0 &&
                       next.scatter < kGrowthOfNoise * here.scatter && !here.signs.of_two_sheets(0) &&
                       !here.err_together() && !planes_turn(group, open[k], open[k + 1]);
    return plain ? std::sqrt(mean_variance(around(group, open[k].said), kTypical)) : 0;
  }
  return 0;
}

std::vector<double> plain_noise_at(const SpatialIndex& cloud, const SpatialIndex& at, double sparsest,
                                   const Context& context) {
  Places places(cloud, at.points(), 2 * kNeighbourhood, context);
  std::vector<OpenFits> open;
  for (std::size_t points = kNeighbourhood; points <= kWidest; points *= 2)
    open.emplace_back(points, places.fits(points));
  const SiteGroups groups = site_groups(at, kSmallestGroup, context);
  std::vector<double> noise(groups.size());
  for_each_index(
      context, noise.size(), [&](std::size_t i) { noise[i] = plain_noise(groups[i], open, sparsest); }, 64);
  return noise;
}

}  // namespace

LoudPlaces find_loud_places(const SpatialIndex& cloud, const NoiseSites& sites, std::vector<double> at_sites,
                            const Context& context) {
  LoudPlaces found;
  found.at_sites = std::move(at_sites);
  const SpatialIndex index(sites.at, context);
  const std::vector<char> near = are_near_loud_ones(index, sites, found.at_sites, context);
  if (near.empty()) return found;
  Positions at;
  std::vector<Index> site;
  {
    const Positions every = sample(cloud.points(), cloud.points().size() / kPointsAPlace);
    const std::vector<Index> nearest = nearest_points(index, every, context);
    for (std::size_t i = 0; i < every.size(); ++i) {
      if (near[nearest[i]] == 0 || sites.two_sheets[nearest[i]] != 0) continue;
      at.push_back(every[i]);
      site.push_back(nearest[i]);
    }
  }
  if (at.size() < kSmallestGroup) return found;
  const SpatialIndex places(at, context);
  // What is ten times as sparse as the cloud where it is sparse is no part of it that a scanner saw alike.
  const double sparsest = size_where_sparse(sites.per_root) / std::sqrt(kLeastPart);
  std::vector<double> louder = plain_noise_at(cloud, places, sparsest, context);
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (!(louder[i] > kLouder * found.at_sites[site[i]])) {
      louder[i] = 0;
      continue;
    }
    found.at.push_back(at[i]);
    found.sigma.push_back(louder[i]);
    found.site.push_back(site[i]);
  }
  const std::vector<Index> place = nearest_points(places, sites.at, context);
  for (std::size_t s = 0; s < near.size(); ++s)
    if (near[s] != 0 && louder[place[s]] > 0) found.at_sites[s] = louder[place[s]];
  return found;
}

}  // namespace rfsmooth::rfs_mesh
