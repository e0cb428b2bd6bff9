/// What is known of a site without windows (site_views.h), and the sites around it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The sites nearest to one that say something by themselves.
inline constexpr std::size_t kSmallestGroup = 12;

/// The quantile of fits that is typical, and that of a normal variable.
inline constexpr double kTypical = 0.35, kTypicalDeviate = -0.385;

/// Of a site; world units.
struct SiteView {
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  double own = 0;        ///< what the 24 points around it show
  double open = 0;       ///< what those around it and its group show
  double most = kNone;   ///< what nearly all of the dozen nearest sites show; kNone: not known
  double slab = kNone;   ///< open, a bound that grows as the ball does; kNone: none, as in layers and where
                         ///< the noise fills the 24 points
  double held = 0;       ///< what the first ball shows that holds the slab; 0: none
  double plain = 0;      ///< noise of one sheet and no shape that is seen for sure; 0: none
  double sheet = kNone;  ///< what each of two sheets shows; kNone: there is one
  double floor = 0;      ///< what steps, shared noise or layers make sure of
  double shared = 1;     ///< points that share the noise around it (site_views.h, shared_around.h)
  bool turned =
      false;  ///< whether wider balls than the first that holds the slab show other planes: no surface
  bool told = false;  ///< whether the scatter stops growing, and is no detail
};

/// By site: the sites nearest to it, the nearest first.
using SiteGroups = std::vector<std::vector<Neighbor>>;

/// So many nearest of each, itself included. O(n log n), parallel.
inline SiteGroups site_groups(const SpatialIndex& sites, std::size_t most, const Context& context) {
  SiteGroups groups(sites.points().size());
  for_each_index(
      context, groups.size(), [&](std::size_t s) { sites.nearest(sites.points()[s], int(most), groups[s]); },
      64);
  return groups;
}

/// The values of the members of a group, or of the `most` nearest of them.
template <class T>
std::vector<T> around(const std::vector<Neighbor>& group, const std::vector<T>& all,
                      std::size_t most = std::numeric_limits<std::size_t>::max()) {
  const std::size_t count = std::min(most, group.size());
  std::vector<T> near;
  near.reserve(count);
  for (std::size_t k = 0; k < count; ++k) near.push_back(all[group[k].index]);
  return near;
}

}  // namespace rfsmooth::rfs_mesh
