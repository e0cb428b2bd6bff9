/// What many scatter fits say together: quantiles by area, and the mean without the fits that stand out.
///
/// A scan has most of its points where its surface is nearest to the scanner, so a fit counts by the area it
/// covers (the square of its ball's radius), up to that of one among the widest quarter. Thread safe, but for
/// the vectors that are reordered.
#pragma once

#include <vector>

#include "base/quantile.h"
#include "rfs_mesh/fit/scatter.h"

namespace rfsmooth::rfs_mesh {

/// A value and how much it counts.
struct Weighed {
  double value, weight;
};

using rfsmooth::quantile;  // of values that count alike

/// The least value that with those below it has `share` of the weight. Sorts. \param values at least one.
double quantile(std::vector<Weighed>& values, double share);

/// Of balls, or anything that grows with the distance between points: how large they are where these are
/// sparse, which the widest quarter exceeds. \param sizes at least one
double size_where_sparse(std::vector<double> sizes);

/// How much each fit counts: 0 to 1.
std::vector<double> areas(const std::vector<Scatter>& all);

/// The same of balls of these radii.
std::vector<double> areas(const std::vector<double>& radii);

/// The variances of the fits that say something, each over the quantile of its own distribution (chi-square
/// over its degrees of freedom, by Wilson and Hilferty 1931) at a standard normal `deviate`: so that fits of
/// different freedom compare. \param area of each fit.
std::vector<Weighed> comparable(const std::vector<Scatter>& all, const std::vector<double>& area,
                                double deviate);

/// The mean variance of the fits, without those above four times the typical one. Typical is the quantile
/// `share` of the fits' variances, brought to the mean by `deviate`, the same quantile of a normal
/// distribution. Zero if no fit says anything.
double mean_variance(const std::vector<Scatter>& all, double share, double deviate);

/// What of a fit counts in such a mean: for means over many groups of the same fits.
struct Said {
  double square;             ///< of the ball's radius, world units squared
  double variance, freedom;  ///< of Scatter
  double comparable;         ///< the variance over the quantile (comparable()); 0: it says nothing
};

/// By fit; `deviate` as for mean_variance.
std::vector<Said> what_they_say(const std::vector<Scatter>& all, double deviate);

/// The mean variance of fits that say this.
double mean_variance(const std::vector<Said>& all, double share);

}  // namespace rfsmooth::rfs_mesh
