/// The noise from how the density of the points falls off, whatever surfaces they were taken from.
///
/// Points with normal noise of deviation sigma have a density rho that is a mixture of normal distributions,
/// one around each place of the surface. Along any direction
///
///     (log rho)'' = -1 / sigma^2 + (variance of the places that a point there may come from) / sigma^4:
///
/// no ridge of the density is narrower than the noise. It is just as wide where one sheet is all that a point
/// may come from, and so it is outside of the outermost one, of walls, rods and stacks of sheets, too. A
/// normal kernel of width b sees the same of the density that it blurs (as in mean shift, Comaniciu and Meer
/// 2002): across the sheet its members have the variance
///
///     lambda = b^2 sigma^2 / (b^2 + sigma^2),   so that   sigma^2 = lambda b^2 / (b^2 - lambda),
///
/// wherever its centre is, and more where they are of several sheets. A window (noise_search.h) must hold all
/// of a sheet's noise, and with it every other sheet within six sigma; a kernel is one sigma wide.
///
/// Kernels stand on points, as far from the surface as the noise carried these, and those count whose members
/// lie farthest to one side. Coming from below, the first kernel counts that is as wide as what it reads.
#pragma once

#include <optional>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// What kernels read, world units.
struct NoiseInKernels {
  double bound;  ///< by the narrowest that hold a ring of points
  /// By those that hold many, if some of these are narrower than the noise, which is then about a spacing or
  /// more. Others are wider than need be, and may hold several sheets.
  std::optional<double> sigma;
};

/// The medians of what is read at the outermost tenth of the points. Nothing where that is more than `most`.
/// On flat and round shapes sigma is read up to 8 % too little, on walls and rods of one to four sigma up to
/// 20 % and on stacks of sheets up to 30 % too much. O(log n), parallel, deterministic.
std::optional<NoiseInKernels> noise_in_kernels(const SpatialIndex& index, double most,
                                               const Context& context);

}  // namespace rfsmooth::rfs_mesh
