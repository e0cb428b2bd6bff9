/// Parts that are far louder than what is around them, such as dark cloth before a laser, and too small for
/// the sites of a cloud to hear: the noise at a site is that of dozens around it (noise_sites.h), which are
/// as many whether the cloud has ten thousand points or a million.
///
/// Where a site sees no second sheet, and its own fit scatters twice as far as the noise there, the points
/// around it are looked at more closely, every eighth of them. Its dozen nearest alike say what noise there
/// is if it is twice what was found, too, and noise that points have of their own: their balls hold the slab
/// of it, twice as many points show hardly more, which shape would, residuals are not of two sheets,
/// nearest points do not err together, and twice as many points lie in the same plane. Nor are they ten times
/// as sparse as the cloud is where it is sparse: those are strays. Thread safe: no state is kept.
#pragma once

#include <vector>

#include "rfs_mesh/noise/sites/noise_sites.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// World units.
struct LoudPlaces {
  Positions at;
  std::vector<double> sigma;     ///< standard deviation along the normal there
  std::vector<Index> site;       ///< the nearest to each
  std::vector<double> at_sites;  ///< by site: as it was, but where the place nearest to it is loud as there
};

/// O(sites), and O(log n) for every eighth point near loud sites. Parallel, deterministic. \param cloud whose
/// points the sites are \param at_sites the noise found there, world units
LoudPlaces find_loud_places(const SpatialIndex& cloud, const NoiseSites& sites, std::vector<double> at_sites,
                            const Context& context);

}  // namespace rfsmooth::rfs_mesh
