/// Points that are several times noisier than their neighbours: mixed pixels, glancing rays, bad matches.
///
/// A share p of the points has noise of `times` times what the rest has, and they lie among the others. Found
/// from what a first smoothing left between each point and the surface, r in units of the noise around it, by
/// expectation maximisation (Dempster, Laird and Rubin 1977) of
///
///     (1 - p) N(0, s^2) + p N(0, (times s)^2).
///
/// Such a point says less of where the surface is, and how much less, its residual tells: that is multiplied
/// by
///
///     w(r) = (P(narrow | r) + P(wide | r) / times^2),
///
/// 1 near the surface, 1 / times^2 far from it: the point of a pseudo-observation (Huber 1981, Robust
/// Statistics, 7.8), on which everything that assumes one normal distribution can then go on.
#pragma once

#include <vector>

#include <rfsmooth/statistics.h>

namespace rfsmooth::smoothing {

/// The law of a cloud's tails.
struct Tails : Statistics::Tails {
  /// What a residual of r (in units of the measured noise) is to be multiplied by.
  double weight(double r) const;
};

/// \param residuals over the noise around each point, of either sign, of a surface that does not follow the
/// points. \param least the same of one that follows edges, not negative: whether there are tails. Of points
/// that have no part in it both are NaN. O(n).
Tails find_tails(const std::vector<float>& residuals, const std::vector<float>& least);

}  // namespace rfsmooth::smoothing
