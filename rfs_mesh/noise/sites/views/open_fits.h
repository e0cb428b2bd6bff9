/// Fits without windows at all sites of a cloud.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "rfs_mesh/fit/places.h"
#include "rfs_mesh/noise/scatter_statistics.h"
#include "rfs_mesh/noise/sites/views/site_view.h"

namespace rfsmooth::rfs_mesh {

/// Fits at all sites to so many points.
struct OpenFits {
  OpenFits(std::size_t count, std::vector<Scatter> fits)
      : points(count), all(std::move(fits)), said(what_they_say(all, kTypicalDeviate)) {}

  /// What they typically scatter by around a site, world units.
  double scatter_around(const std::vector<Neighbor>& group) const;
  /// The median radius of their balls there, world units.
  double radius_around(const std::vector<Neighbor>& group) const;
  /// What depths in steps add there by their rounding, world units.
  double rounding_around(const std::vector<Neighbor>& group) const;

  std::size_t points;
  std::vector<Scatter> all;
  std::vector<Said> said;
  std::vector<double> rounding;  ///< what depths in steps add there, world units; empty: not in steps
};

/// Fits to so many points that their balls overlap: some sites are fitted, and each takes the fit of the
/// nearest of these. O(sites). Parallel, deterministic. \param places the sites
OpenFits fit_wide(const Places& places, std::size_t points, const Context& context);

/// Whether the planes of the fits around a site are not those of fits to more points: turned so far that they
/// leave even the thickest slab within the ball. A surface has one plane, leaves and branches have any.
bool planes_turn(const std::vector<Neighbor>& group, const OpenFits& fits, const OpenFits& wider);

}  // namespace rfsmooth::rfs_mesh
