/// What the fits without windows around a site show together, in two ways. Whether their scatter grows, and
/// whether points err together, is asked of the typical one among all sites of the group: a few that cross an
/// edge have no say (FitsAround). Whether they see two sheets or layers is told by moments of residuals,
/// which scatter far more: there the mean of the two dozen nearest counts (MomentsAround).
#pragma once

#include <vector>

#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/shared/signs_of_sharing.h"
#include "rfs_mesh/noise/sites/views/open_fits.h"

namespace rfsmooth::rfs_mesh {

/// The typical one of the fits to so many points.
struct FitsAround {
  FitsAround(const std::vector<Neighbor>& group, const OpenFits& open);

  bool holds_slab() const { return scatter < kFlatSlab * radius; }
  bool in_rows() const { return signs.err_in_rows(points); }
  bool err_together() const { return signs.err_together(points); }
  bool row_by_row() const { return signs.err_row_by_row(points); }

  double points;
  double scatter = 0;  ///< the typical one, world units; 0: no fit says a thing
  double radius = 0;   ///< the median of their balls', world units
  /// Of those that scatter at most twice as far: across an edge all residuals of a side are alike, and a few
  /// such fits would speak for the others.
  SignsOfSharing signs;
};

/// The means of the residuals' moments, of the fits to so many points.
struct MomentsAround {
  MomentsAround(const std::vector<Neighbor>& group, const OpenFits& open);

  double variance() const { return mean_variance(said, kTypical); }
  /// Whether the residuals are distributed as normal noise is: those of an edge have more in their middle and
  /// far out, those of two sheets less.
  bool normal() const;
  /// Whether points of a row lie to the same side.
  bool alike_in_rows() const { return in_row > kLittle; }
  /// The median of their balls', world units.
  double radius() const;

  std::vector<Said> said;
  std::size_t points;
  double freedom = 0, flatness = 0, middle = 0, beside = 0;  ///< those of Scatter; nan: no fit says a thing
  double in_row = 0;                                         ///< the same
  double lean = 0;                                           ///< the same, beyond chance
};

}  // namespace rfsmooth::rfs_mesh
