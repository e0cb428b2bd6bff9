#include "rfs_mesh/noise/sites/views/shared_around.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/sites/views/fits_around.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Whether residuals are those of two sheets or of waves. \param own variance that points have of their own,
/// or more
bool is_flat(const FitsAround& fits, double own) {
  return fits.signs.of_two_sheets(own / (fits.scatter * fits.scatter));
}

/// Whether the fits to m points show rows, and those to the fewest, or to twice as many, do already: a wave
/// that points resolve is wider than their balls, and only wider ones show that it has crests.
bool in_narrow_rows(const std::vector<FitsAround>& shown, const FitsAround& at_m) {
  return at_m.in_rows() && (shown[0].in_rows() || shown[1].in_rows());
}

/// Whether the variance grows from one to the next as only shape does, if not rows of points.
bool grows_as_shape(const FitsAround& at_m, const FitsAround& at_2m) {
  return at_2m.scatter * at_2m.scatter > kLeastGrowthOfShape * at_m.scatter * at_m.scatter;
}

/// Whether m and 2 m show rows that each err by themselves, and 4 m hardly more, as shape would. A quadric
/// follows three of them, so that few rows grow as fast as shape at first, and are flat, too: L values about
/// their mean have a flatness of 3 (L - 1) / (L + 1). Two sheets that were scanned in rows are flatter still.
bool are_rows(const FitsAround& at_m, const FitsAround& at_2m, const FitsAround& at_4m) {
  return at_m.row_by_row() && at_2m.row_by_row() && at_2m.signs.flatness > kEvenFlatness &&
         !grows_as_shape(at_2m, at_4m);
}

/// The first of these from which the scatter has stopped growing, and is of noise that neighbours share, if
/// it never grew as shape does before; or how many there are. \param shown the narrowest holds the slab.
/// \param in_steps whether depths are: terraces are rows, too, and known (depth_steps.h)
std::size_t stops_at(const std::vector<FitsAround>& shown, bool in_steps) {
  const double narrow = shown.front().scatter;
  for (std::size_t i = 0; i + 2 < shown.size(); ++i) {
    const FitsAround &here = shown[i], &next = shown[i + 1], &last = shown[i + 2];
    const bool grew = next.scatter > (here.in_rows() ? kSameNoise : kGrowthOfNoise) * narrow;
    // Where the narrowest see several rows, they see their noise, too.
    const double own = in_narrow_rows(shown, here) ? 0 : narrow;
    const bool stopped = last.scatter <= kGrowthOfNoise * here.scatter && !is_flat(next, own * own);
    if (here.holds_slab() && grew && here.err_together() && !next.signs.of_relief() &&
        (stopped || (!in_steps && are_rows(here, next, last))))
      return i;
    if (grows_as_shape(here, next) && (in_steps || !next.row_by_row())) break;
  }
  return shown.size();
}

/// The variance of noise that rows share, from what a quadric leaves of it among m and among 4 m points. Of L
/// rows it follows as three coefficients do, and L grows with the root of m: 1 - c / sqrt(m) is left.
double variance_of_rows(const FitsAround& at_m, const FitsAround& at_4m) {
  return 2 * at_4m.scatter * at_4m.scatter - at_m.scatter * at_m.scatter;
}

/// What is found at a site.
struct SharedAround {
  double sigma = 0;  ///< world units; 0: nothing
  double points = 1;
};

SharedAround look_around(const std::vector<Neighbor>& group, const std::vector<OpenFits>& open) {
  std::vector<FitsAround> shown;
  for (const OpenFits& fits : open) {
    const FitsAround next(group, fits);
    // Narrower balls are inside of the slab, and see the less of the noise the narrower they are.
    if (!shown.empty() || (next.scatter > 0 && next.holds_slab())) shown.push_back(next);
  }
  if (shown.empty()) return {};
  const bool in_steps = !open.front().rounding.empty();
  const std::size_t stop = stops_at(shown, in_steps);
  if (stop == shown.size()) return {};
  const std::size_t at_m = open.size() - shown.size() + stop;
  if (planes_turn(group, open[at_m], open[at_m + 2])) return {};
  double sigma = shown[stop + 1].scatter;
  if (in_narrow_rows(shown, shown[stop]) || (!in_steps && shown[stop].row_by_row()))
    sigma = std::sqrt(std::max(sigma * sigma, variance_of_rows(shown[stop], shown[stop + 2])));
  std::vector<double> m, left;
  for (std::size_t i = 0; i <= stop + 1; ++i) {
    const double share = shown[i].scatter / sigma;
    m.push_back(shown[i].points);
    left.push_back(std::min(1.0, share * share));
  }
  return {sigma, points_sharing(m, left)};
}

}  // namespace

void find_shared_around(const SiteGroups& groups, const std::vector<OpenFits>& open,
                        std::vector<SiteView>& views, const Context& context) {
  std::vector<SharedAround> found(views.size());
  for_each_index(
      context, groups.size(),
      [&](std::size_t s) {
        if (views[s].sheet == SiteView::kNone) found[s] = look_around(groups[s], open);
      },
      64);
  const auto count = std::count_if(found.begin(), found.end(), [](const auto& f) { return f.sigma > 0; });
  if (!(double(count) > kLeastPart * double(found.size()))) return;
  for (std::size_t s = 0; s < views.size(); ++s) {
    if (!(found[s].sigma > 0)) continue;
    views[s].floor = std::max(views[s].floor, found[s].sigma);
    views[s].told = true;
    views[s].shared = std::max(views[s].shared, found[s].points);
  }
}

}  // namespace rfsmooth::rfs_mesh
