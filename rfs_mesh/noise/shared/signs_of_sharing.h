/// What tells noise that neighbours share from noise of their own and from shape, and how many share it: for
/// a cloud (shared_noise.h) as for the places around a site (sites/shared_around.h). Thread safe.
#pragma once

#include <cmath>
#include <vector>

#include "rfs_mesh/fit/scatter.h"

namespace rfsmooth::rfs_mesh {

/// Of the variance about a quadric, from m points to 2 m: shape that it does not follow grows at least so.
constexpr double kLeastGrowthOfShape = 2.38;

/// How the residuals of some fits lie, taken together. Who is about to believe what 2 m points show asks the
/// fits to 2 m whether they are of two sheets or of relief. Whether they err together a site asks those to m,
/// a cloud those to 2 m, and those to m before it is sure; it asks neither that nor for relief on terraces,
/// and of two sheets not between two depths. In which order does not matter.
struct SignsOfSharing {
  /// Mean of Scatter::together: 1, less what patches follow of it, of noise that points have of their own, up
  /// to kRing where they share it.
  double together = 0;
  /// Mean of Scatter::in_rows: the same of lines of a scanner that are each off by itself.
  double in_rows = 0;
  /// Means of Scatter::in_row and next_row.
  double in_row = 0, next_row = 0;
  /// Medians of Scatter::flatness and lean_in_common, since that of a few rocks on a sea floor is large.
  double flatness = 0, lean = 0;

  /// Whether nearest points lie off patches of m points the same way: `together` is above that of points on
  /// their own, which is what patches do not follow of it, m / (m + 45). Or they do so along rows.
  bool err_together(double m) const;
  /// Whether points in a row lie off the same way, beyond what chance and patches of m points make of it.
  bool err_in_rows(double m) const;
  /// Whether they do by far, and the next row tells little of it, as it would of a wave: rows that each err
  /// by themselves.
  bool err_row_by_row(double m) const;
  /// Whether they are as flat as those of two sheets, beyond the noise that points have of their own, `own`
  /// of the variance.
  bool of_two_sheets(double own) const;
  /// Whether they lean as those of stones do, round above and in clefts below.
  bool of_relief() const;
};

/// Of fits that say something; zeros if there are none.
SignsOfSharing signs_of(const std::vector<const Scatter*>& fits);

/// The greatest k from 1 to `most` of which `below` is true: it is up to some k, and of none beyond.
template <class Below>
double greatest_below(double most, const Below& below) {
  double fewest = 1;
  for (int round = 0; round < 40; ++round) {
    const double middle = std::sqrt(fewest * most);
    (below(middle) ? fewest : most) = middle;
  }
  return fewest;
}

/// g(k / m) of shared_noise.h: of noise that k points share, what a quadric through m leaves of the variance.
double left_by_quadric(double points, double m);

/// k, the points that share the noise: the greatest that is told by the neighbourhood that sees half of its
/// variance, between two of these m where none sees just that, or by a wider one. Of noise that is a sum of
/// parts, narrow patches see the part that fewest share; wide ones follow it as noise that their mean k
/// share, and smoothing takes wide ones. If the narrowest sees more than half, it and wider ones tell. \param
/// m points of the neighbourhoods, ascending, at least one. \param left what a quadric leaves of the noise
/// there, over its variance, at most 1: g(k / m). At least 1, at most the last m.
double points_sharing(const std::vector<double>& m, const std::vector<double>& left);

/// The k of noise whose variance about a quadric grows so from m to 2 m points: the more points share it, the
/// faster, up to a k of m / 4, which is the most that is returned.
double points_by_growth(double m, double growth);

}  // namespace rfsmooth::rfs_mesh
