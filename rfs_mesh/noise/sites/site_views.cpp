#include "rfs_mesh/noise/sites/site_views.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/sites/fits_around.h"
#include "rfs_mesh/noise/sites/open_fits.h"
#include "rfs_mesh/noise/sites/shared_around.h"
#include "rfs_mesh/sheets/two_sheets.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Of eight times the points: inside a thick slab their ball has twice the radius and sees twice the scatter.
constexpr std::size_t kFarther = 8, kPlateauTo = kFarther * kNeighbourhood,
                      kWidestView = kFarther * kPlateauTo;
// Scatter::middle above which noise so flat is that of no two sheets: nearly that of an even distribution.
constexpr double kMiddleOfSheets = 0.25;
// Coefficients of a quadric.
constexpr double kOfQuadric = 6;

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

/// What each of two sheets shows by itself, of fits that hold both; world units.
double noise_of_sheet(const MomentsAround& around) {
  const double share = share_of_sheet(around.flatness, std::max(0.0, around.lean));
  // The quadric bends to the sheet that happens to have more points here and there, and so spreads what
  // lies between the sheets; by its share of the degrees of freedom.
  const double spread = (1 - share) * kOfQuadric / (around.freedom + kOfQuadric);
  const double least = kNarrowestWindow * kNarrowestWindow;
  return std::sqrt(around.variance() * std::max(least, share - spread));
}

/// Whether the fits show two layers that are nearer to each other than their points are, and no sheets.
/// \param apart NoiseModel::apart
bool are_layers(const MomentsAround& around, double apart) {
  if (!(around.flatness < kNormalFlatness)) return false;
  const double lean = std::max(0.0, around.lean), of_sheet = share_of_sheet(around.flatness, lean);
  if (!(of_sheet < share_of_sheet(kFlatnessOfSheets))) return false;
  const double radius = around.radius(), square = square_of_point(radius * radius, around.points),
               nearest = lean > 0 ? square : squared_nearest(square, apart);
  return squared_gap(of_sheet, lean) * around.variance() < nearest;
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

/// The sites, and the depths in steps that they may have; null: they have none.
struct Sites {
  const SiteGroups& groups;
  const DepthSteps* steps;
  bool on_lines;
  double apart;  ///< NoiseModel::apart

  bool on_grid() const { return steps != nullptr && steps->on_grid(); }

  /// What depths in steps add around there by their rounding, world units.
  double rounding_around(std::size_t s, const OpenFits& fits) const {
    if (steps == nullptr) return 0;
    return quantile_of(groups[s], 0.5, [&](const Neighbor& q) { return fits.rounding[q.index]; });
  }

  /// Sets `sheet`, and `middle` to Scatter::middle, where two sheets are seen, farther apart than two depths
  /// that follow each other; or `floor` if these are layers.
  void look_for_sheets(std::size_t s, const std::vector<OpenFits>& open, SiteView& view,
                       double& middle) const {
    std::vector<MomentsAround> seen;
    for (const OpenFits& fits : open) seen.emplace_back(groups[s], fits);
    const auto grows = [&](std::size_t k) {  // to or from the next, as only shape does
      const std::size_t next = std::min(k + 1, seen.size() - 1);
      return next > 0 && seen[next].variance() > kGrowthOfNoise * kGrowthOfNoise * seen[next - 1].variance();
    };
    const auto exceeds_rounding = [&](std::size_t k) {
      const double depths = on_grid() ? 2 : 1;  // with no empty voxel between them there is one sheet
      return !are_two_depths(seen[k].variance(), depths * rounding_around(s, open[k]));
    };
    std::size_t flattest = 0;
    double flatness = kFlatnessOfSheets;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (!(seen[k].flatness < flatness) || grows(k)) continue;
      flattest = k;
      flatness = seen[k].flatness;
    }
    const bool two = flatness < kFlatnessOfSheets;
    if (two && exceeds_rounding(flattest)) {
      view.sheet = noise_of_sheet(seen[flattest]);
      middle = seen[flattest].middle;
    }
    if (on_lines) return;
    const std::size_t k = two && seen[flattest].lean <= 0 ? flattest : 0;
    if (!are_layers(seen[k], apart) || !exceeds_rounding(k)) return;
    view.sheet = view.slab = SiteView::kNone;
    view.floor = std::sqrt(seen[0].variance());
  }

  /// What the fits around there typically scatter by, world units.
  double scatter_around(std::size_t s, const OpenFits& fits) const {
    return std::sqrt(
        quantile_of(groups[s], kTypical, [&](const Neighbor& q) { return fits.all[q.index].variance; }));
  }

  /// The median radius of their balls, world units.
  double radius_around(std::size_t s, const OpenFits& fits) const {
    return quantile_of(groups[s], 0.5, [&](const Neighbor& q) { return fits.all[q.index].radius; });
  }

  /// Raises `floor` and sets `told`: what two sheets scatter does not grow, either. Raises `floor` to what
  /// depths in steps make sure of, too, as far as the widest fits show it: those to fewer points may lie
  /// within a step. A stack of slices has few depths, too, and none of the scatter; a grid may be exact. Sets
  /// `shared`, but along lines, which are no disks. \param open from the fewest points to the widest; `many`
  /// of them to kPlateauTo points. \param width of the strip on one step, at each site
  void find_floor(std::size_t s, const std::vector<OpenFits>& open, const OpenFits& many,
                  const std::vector<double>& width, SiteView& view) const {
    const double less = scatter_around(s, open.front()), seen = scatter_around(s, many);
    if (view.sheet == SiteView::kNone)
      view.floor = std::max(view.floor, plateau(less, seen, radius_around(s, open.front())));
    view.told = seen < kStops * less;
    if (steps == nullptr || on_grid()) return;
    const double rounding = rounding_around(s, many);
    view.floor = std::max(view.floor, std::min(scatter_around(s, open.back()), rounding));
    if (on_lines) return;
    const double across = quantile_of(groups[s], 0.5, [&](const Neighbor& q) { return width[q.index]; });
    const double share = std::min(1.0, across / (2 * radius_around(s, many)));
    view.shared = points_on_step(double(many.points) * (share * share), seen, rounding);
  }
};

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

/// Sets `held` and `plain`. \param open from kNeighbourhood points on, each of twice as many
void hold_slabs(const Places& places, const SiteGroups& groups, const std::vector<OpenFits>& open,
                std::vector<SiteView>& views, const Context& context) {
  const std::size_t widest = widest_scatter(places.index());
  std::vector<Shown> before;
  std::size_t holding = kNeighbourhood;
  for (const OpenFits& fits : open) {
    const std::size_t points = fits.points;
    if (points > widest) break;
    std::vector<Shown> now = shown_around(groups, fits, context);
    for (std::size_t s = 0; s < views.size(); ++s) {
      SiteView& view = views[s];
      if (points == holding && !(view.held > 0) && now[s].held) view.held = now[s].scatter;
      if (!before.empty() && !(view.plain > 0) && before[s].held && before[s].normal &&
          now[s].scatter < kGrowthOfNoise * before[s].scatter)
        view.plain = before[s].scatter;
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
  const Sites sites{groups, steps, start.on_lines, start.apart};
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
        sites.look_for_sheets(s, open, view, middle[s]);
      },
      64);
  forget_flat_noise(middle, views);
  const bool plateau = open.back().points == kPlateauTo;
  const std::size_t many = open.size() - 1;
  for (; points <= std::min(kWidestView, widest_scatter(places.index())); points *= 2)
    open.push_back(fit_wide(places, points, context));
  std::vector<double> width;
  if (plateau)
    for (std::size_t s = 0; s < groups.size(); ++s)
      width.push_back(steps_there[s].width(open[many].all[s].normal));
  if (plateau)
    for_each_index(
        context, groups.size(),
        [&](std::size_t s) { sites.find_floor(s, open, open[many], width, views[s]); }, 64);
  if (plateau && !start.on_lines && !sites.on_grid()) find_shared_around(groups, open, views, context);
  hold_slabs(places, groups, open, views, context);
  return views;
}

}  // namespace rfsmooth::rfs_mesh
