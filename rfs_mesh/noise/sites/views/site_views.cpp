#include "rfs_mesh/noise/sites/views/site_views.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/sites/views/fits_around.h"
#include "rfs_mesh/noise/sites/views/open_fits.h"
#include "rfs_mesh/noise/sites/views/shared_around.h"
#include "rfs_mesh/noise/sites/views/sheets_around.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Of eight times the points: inside a thick slab their ball has twice the radius and sees twice the scatter.
constexpr std::size_t kFarther = 8, kPlateauTo = kFarther * kNeighbourhood,
                      kWidestView = kFarther * kPlateauTo;
// Scatter::middle above which noise so flat is that of no two sheets: nearly that of an even distribution.
constexpr double kMiddleOfSheets = 0.25;
// Times, from kNeighbourhood to kPlateauTo points: less than this, and scatter is noise; more than that,
// shape. Chosen on depths in steps and shared noise (noise_accuracy_test.cpp), so that it says nothing on
// the clean development shapes.
constexpr double kStops = 1.6, kNeverStops = 1.9;

/// What scatter at kNeighbourhood points, `few`, and at kPlateauTo, `many`, makes sure of. \param radius of
/// the ball of the few.
double plateau(double few, double many, double radius) {
  constexpr double kSure = 0.65;
  constexpr double kThin = 0.14, kThick = 0.2;
  if (!(few > 0)) return 0;
  const double growth = many / few, share = few / radius;
  const double trust = std::clamp((growth - 1) / (kSameNoise - 1), 0.0, 1.0) *
                       std::clamp((kNeverStops - growth) / (kNeverStops - kStops), 0.0, 1.0) *
                       std::clamp((kThick - share) / (kThick - kThin), 0.0, 1.0);
  return trust * std::max(few, kSure * many);
}

/// What nearly all of the dozen nearest show, where their balls hold the slab.
double bound(const std::vector<Neighbor>& group, const std::vector<Scatter>& open) {
  constexpr double kNearlyAll = 0.75;
  const std::vector<Scatter> near = around(group, open, kSmallestGroup);
  const double seen = std::sqrt(quantile_of(near, kNearlyAll, &Scatter::variance));
  return seen < kFlatSlab * quantile_of(near, 0.5, &Scatter::radius) ? seen : SiteView::kNone;
}

/// How many points share their noise where depths in steps are off by `rounding`: 1, or more by a difference.
///
///     1 + (on_strip - 1) min(1, v) exp(-pi^2 / 3 o) / (1 + o)
///     v = scatter^2 / rounding^2,   o = max(0, v - 1)
///
/// What rounding adds is a saw tooth. The noise that points had before, o times as large in variance, leaves
/// the exponential of it, as of a sine as long as a step, and that is one part in 1 + o of all noise. What
/// lies exactly within one step shows less than there is: v. \param on_strip points of a disk as wide as the
/// strip on one step. \param scatter of the points there
double points_on_step(double on_strip, double scatter, double rounding) {
  if (!(rounding > 0 && on_strip > 1)) return 1;
  const double seen = scatter * scatter / (rounding * rounding), before = std::max(0.0, seen - 1),
               saw = std::min(1.0, seen) * std::exp(-M_PI * M_PI / 3 * before) / (1 + before),
               points = 1 + (on_strip - 1) * saw;
  return points > kSameNoise ? points : 1;
}

/// Raises `floor` and sets `told`: what two sheets scatter does not grow, either. Raises `floor` to what
/// steps make sure of, too, as far as the widest fits show it: those to fewer points may lie within a step.
/// Sets `shared` by them. \param open from the fewest points to the widest; `many` of them to kPlateauTo
/// points. \param terraces whether depths are in steps. A stack of slices has few depths, too, and none of
/// the scatter; a grid, which has no terraces, may be exact. \param width of the strip on one step, at each
/// site; empty: along lines, which are no disks
void find_floor(const std::vector<Neighbor>& group, const std::vector<OpenFits>& open, const OpenFits& many,
                bool terraces, const std::vector<double>& width, SiteView& view) {
  const OpenFits& few = open.front();
  const double less = few.scatter_around(group), seen = many.scatter_around(group);
  if (view.sheet == SiteView::kNone)
    view.floor = std::max(view.floor, plateau(less, seen, few.radius_around(group)));
  view.told = seen < kStops * less;
  if (!terraces) return;
  const double rounding = many.rounding_around(group);
  view.floor = std::max(view.floor, std::min(open.back().scatter_around(group), rounding));
  if (width.empty()) return;
  const double across = quantile_of(group, 0.5, [&](const Neighbor& q) { return width[q.index]; });
  const double share = std::min(1.0, across / (2 * many.radius_around(group)));
  view.shared = points_on_step(double(many.points) * (share * share), seen, rounding);
}

/// Forgets the sheets if it is the noise itself that is flat, and not empty in its middle. \param middle of
/// each site
void forget_flat_noise(const std::vector<double>& middle, std::vector<SiteView>& views) {
  double sum = 0, parted = 0;
  for (std::size_t s = 0; s < views.size(); ++s) {
    if (views[s].sheet == SiteView::kNone) continue;
    sum += middle[s];
    ++parted;
  }
  if (sum > kMiddleOfSheets * parted)
    for (SiteView& view : views) view.sheet = SiteView::kNone;
}

/// What the fits around a site show without windows.
struct Shown {
  double scatter;  ///< world units
  bool held;       ///< whether their balls hold the slab of noisy points
  bool normal;     ///< MomentsAround::normal
};

std::vector<Shown> shown_around(const SiteGroups& groups, const OpenFits& open, const Context& context) {
  std::vector<Shown> shown(groups.size());
  for_each_index(
      context, groups.size(),
      [&](std::size_t s) {
        const MomentsAround nearest(groups[s], open);
        const double scatter = std::sqrt(nearest.variance());
        shown[s] = {scatter, scatter < kFlatSlab * nearest.radius(), nearest.normal()};
      },
      64);
  return shown;
}

/// Sets `held`, `plain` and `turned`. \param open from kNeighbourhood points on, each of twice as many
/// \param piece fewer points are on lines, through which any plane goes
void hold_slabs(const Places& places, const SiteGroups& groups, const std::vector<OpenFits>& open,
                std::size_t piece, std::vector<SiteView>& views, const Context& context) {
  const std::size_t widest = widest_scatter(places.index());
  std::vector<Shown> before;
  std::vector<char> looked(views.size(), 0);
  std::size_t holding = kNeighbourhood;
  for (std::size_t k = 0; k < open.size(); ++k) {
    const OpenFits &fits = open[k], &wider = open[std::min(k + 2, open.size() - 1)];
    const std::size_t points = fits.points;
    if (points > widest) break;
    std::vector<Shown> now = shown_around(groups, fits, context);
    for (std::size_t s = 0; s < views.size(); ++s) {
      SiteView& view = views[s];
      if (points == holding && !(view.held > 0) && now[s].held) view.held = now[s].scatter;
      if (!before.empty() && !(view.plain > 0) && before[s].held && before[s].normal &&
          now[s].scatter < kGrowthOfNoise * before[s].scatter)
        view.plain = before[s].scatter;
      if (looked[s] != 0 || points < piece || !now[s].held) continue;
      view.turned = planes_turn(groups[s], fits, wider);
      looked[s] = 1;
    }
    if (std::all_of(views.begin(), views.end(), [](const SiteView& v) { return v.held > 0 && v.plain > 0; }))
      return;
    if (points == holding) holding *= kFarther;
    before = std::move(now);
  }
}

}  // namespace

std::vector<SiteView> look_without_windows(Places& places, const SiteGroups& groups, const NoiseStart& start,
                                           const DepthSteps* steps, const Context& context) {
  const std::size_t n = places.index().points().size();
  std::vector<OpenFits> open;
  std::size_t points = kNeighbourhood;
  for (; open.empty() || (points <= kPlateauTo && n >= 2 * points); points *= 2)
    open.emplace_back(points, places.fits(points));
  const std::vector<LocalSteps> steps_there = steps_at(places, steps);
  if (steps != nullptr)
    for (OpenFits& fits : open) fits.rounding = rounding_at(steps_there, fits.all);
  const bool deep = start.fills_nearest();
  const std::vector<Scatter>& few = open.front().all;
  const std::vector<Scatter> wide = deep ? places.fits(start.m) : std::vector<Scatter>();
  const bool on_grid = steps != nullptr && steps->on_grid(), on_terraces = steps != nullptr && !on_grid;
  std::vector<SiteView> views(groups.size());
  std::vector<double> middle(groups.size(), 1);
  for_each_index(
      context, groups.size(),
      [&](std::size_t s) {
        SiteView& view = views[s];
        view.own = std::sqrt(few[s].variance);
        view.open = std::sqrt(mean_variance(around(groups[s], open.front().said), kTypical));
        if (!deep) view.slab = view.open;
        view.most = bound(groups[s], deep ? wide : few);
        const SheetsAround sheets = look_for_sheets(groups[s], open, start, on_grid);
        view.sheet = sheets.sheet;
        middle[s] = sheets.middle;
        if (!sheets.layers) return;
        view.slab = SiteView::kNone;
        view.floor = *sheets.layers;
      },
      64);
  forget_flat_noise(middle, views);
  const bool plateau = open.back().points == kPlateauTo;
  const std::size_t many = open.size() - 1;
  for (; points <= std::min(kWidestView, widest_scatter(places.index())); points *= 2)
    open.push_back(fit_wide(places, points, context));
  std::vector<double> width;
  if (plateau && on_terraces && !start.on_lines)
    for (std::size_t s = 0; s < groups.size(); ++s)
      width.push_back(steps_there[s].width(open[many].all[s].normal));
  if (plateau)
    for_each_index(
        context, groups.size(),
        [&](std::size_t s) { find_floor(groups[s], open, open[many], on_terraces, width, views[s]); }, 64);
  if (plateau && !start.on_lines && !on_grid) find_shared_around(groups, open, views, context);
  hold_slabs(places, groups, open, start.piece, views, context);
  return views;
}

}  // namespace rfsmooth::rfs_mesh
