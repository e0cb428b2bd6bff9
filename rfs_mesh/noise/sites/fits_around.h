/// What the fits without windows around a site show together.
#pragma once

#include <vector>

#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/shared/signs_of_sharing.h"
#include "rfs_mesh/noise/sites/open_fits.h"

namespace rfsmooth::rfs_mesh {

/// Of the fits to so many points.
struct FitsAround {
  FitsAround(const std::vector<Neighbor>& group, const OpenFits& open);

  bool holds_slab() const { return scatter < kFlatSlab * radius; }
  bool in_rows() const { return signs.err_in_rows(points); }
  bool err_together() const { return signs.err_together(points); }

  double points;
  double scatter = 0;  ///< the typical one, world units; 0: no fit says a thing
  double radius = 0;   ///< the median of their balls', world units
  /// Of those that scatter at most twice as far: across an edge all residuals of a side are alike, and a few
  /// such fits would speak for the others.
  SignsOfSharing signs;
};

}  // namespace rfsmooth::rfs_mesh
