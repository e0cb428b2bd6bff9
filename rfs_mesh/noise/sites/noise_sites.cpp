#include "rfs_mesh/noise/sites/noise_sites.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/sites/views/site_views.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the development shapes with noise of 0.1 to 4 spacings, Gaussian and along the ray
// (tests/bench/noise).
// Sites of a group x m: where fits to many points say much each, fewer are needed.
constexpr std::size_t kGroupWork = 800;
constexpr double kDiffers = 1.5;        // of variances of a dozen fits: two standard errors and more
constexpr double kLeastSpeaking = 0.7;  // of the fits around a site, to be believed
// At m = 16 noise may be below the detail: less of s^2(m) need be noise.
constexpr double kLeastNarrow = 0.4, kLeastWide = 0.5;
// Wider, the ball is still a little too narrow for the slab, and shows that much more at 2 m.
constexpr double kOfTheSlab = 1.07;
// The residuals within a window show its own variance if they are of a normal distribution that it was made
// for, three times that if they fill it evenly, as those of a far louder one do. Full: the geometric mean of
// the two factors.
constexpr double kEven = 3, kFilled = 1.73;
constexpr int kOpeningRounds = 8;  // in which windows open

/// Fits at the sites, and what each site's neighbours say together.
class Listener {
 public:
  Listener(const SpatialIndex& cloud, const Positions& at, const NoiseStart& start, const DepthSteps* steps,
           const Context& context)
      : n_(cloud.points().size()),
        context_(context),
        places_(cloud, at, std::min(n_, 2 * start.m), context),
        group_(site_groups({at, context},
                           std::clamp(kGroupWork / start.m, kSmallestGroup, 2 * kNeighbourhood), context)),
        narrow_(at.size(), 0),
        fits_(at.size()),
        points_(at.size(), 0),
        window_(at.size(), 0),
        from_(at.size()),
        least_opened_by_(at.size(), kFilled),
        widest_(widest_scatter(cloud)),
        start_(start.sigma),
        deep_(start.fills_nearest()),
        m(points_to_fit(places_, start)),
        sigma(at.size(), std::max(start.sigma, start.least)),
        floor(at.size(), 0),
        speaks(at.size(), 0) {
    // The first windows are as wide as what a site makes sure of, and no wider than a sheet.
    views = look_without_windows(places_, group_, start, steps, context);
    std::size_t louder = 0;
    for (std::size_t s = 0; s < at.size(); ++s) {
      louder += std::size_t(views[s].sheet == SiteView::kNone && is_plainly_louder(s));
      floor[s] = views[s].floor;
      sigma[s] = std::max(floor[s], std::min(sigma[s], views[s].sheet));
    }
    loud_part_ = double(louder) > kLeastPart * double(at.size());
  }

  /// One round that opens windows which are too narrow for their places; false if there are none. A window
  /// that is too narrow shows less than there is, but more than it was made for. A place far louder than the
  /// start fills its window evenly, and keeps so little of the weight that no fit says anything. Nor does one
  /// where the second sheet of a wall is cut off; but there the window is not full.
  bool open_windows() {
    const std::vector<char> renewed = renew_fits(1);
    std::vector<char> opened(group_.size(), 0);
    const std::vector<Said> said = what_they_say(fits_, kTypicalDeviate);
    const double where_sparse = size_where_sparse(per_root(fits_));
    for_each_index(
        context_, group_.size(),
        [&](std::size_t s) {
          if (!any_of_group(s, renewed)) return;
          std::vector<double> full;
          for (const Neighbor& q : group_[s]) {
            const Scatter& fit = fits_[q.index];
            if (fit.within > 0) full.push_back(fit.within / (window_[q.index] * window_[q.index]));
          }
          if (hear_at(s, said, 1)) {
            opened[s] = char(opens_on(s));
          } else {
            // Nearly nothing around is left within windows made for far calmer places.
            const bool empty = double(full.size()) < (1 - kLeastSpeaking) * double(group_[s].size());
            if (views[s].sheet == SiteView::kNone) open_window(s, empty ? kEven : quantile(full, 0.5));
            opened[s] = char(sigma[s] > window_[s]);
          }
          const double radius = radius_around(s);
          if (sigma[s] > (all_seen(s) ? kSameNoise : kLouder) * start_ ||
              denser(radius / std::sqrt(double(m[s])), where_sparse))
            opened[s] = char(widen(s, radius) || opened[s] != 0);
        },
        64);
    places_.move_to_feet(fits_);
    return std::find(opened.begin(), opened.end(), 1) != opened.end();
  }

  /// Fits `times` m points with each site's own window and renews `sigma`; `move`: the places go to the
  /// surface. Returns the fits.
  const std::vector<Scatter>& hear(std::size_t times, bool move) {
    const std::vector<char> renewed = renew_fits(times);
    const std::vector<Said> said = what_they_say(fits_, kTypicalDeviate);
    for_each_index(
        context_, group_.size(),
        [&](std::size_t s) {
          if (any_of_group(s, renewed)) hear_at(s, said, times);
        },
        64);
    if (move) places_.move_to_feet(fits_);
    return fits_;
  }

  /// Silences far louder sites whose ball never came to hold what they show, however many points it took:
  /// leaves and twigs fill any ball, and are no surface. They have the noise of the start, and whoever speaks
  /// near them speaks for them. Returns NoiseSites::volume.
  std::vector<double> silence_volumes() {
    std::vector<double> volume(group_.size(), 0);
    for_each_index(
        context_, group_.size(),
        [&](std::size_t s) {
          if (!(sigma[s] > kMuchLouder * start_) || m[s] >= widest_ || floor[s] > 0) return;
          if (sigma[s] <= kThickSlab * radius_around(s)) return;
          volume[s] = sigma[s];
          speaks[s] = 0;
          sigma[s] = start_;
        },
        64);
    return volume;
  }

  /// By site: the radius of its ball over the root of m, so that balls of more points do not count as more
  /// surface. \param all fits to m points
  std::vector<double> per_root(const std::vector<Scatter>& all) const {
    std::vector<double> of;
    for (std::size_t s = 0; s < all.size(); ++s) of.push_back(all[s].radius / std::sqrt(double(m[s])));
    return of;
  }

  /// The medians of these over the sites around each: points at random are denser here and there.
  std::vector<double> medians_around(const std::vector<double>& of_sites) const {
    std::vector<double> medians;
    for (const std::vector<Neighbor>& group : group_)
      medians.push_back(quantile_of(group, 0.5, [&](const Neighbor& q) { return of_sites[q.index]; }));
    return medians;
  }

 private:
  /// The median radius of the balls around a site, world units.
  double radius_around(std::size_t s) const {
    return quantile_of(group_[s], 0.5, [&](const Neighbor& q) { return fits_[q.index].radius; });
  }

  /// Fits `times` m points where these, the window or the place are others than before. Returns where.
  std::vector<char> renew_fits(std::size_t times) {
    std::vector<char> wanted(group_.size());
    for (std::size_t s = 0; s < wanted.size(); ++s) {
      const std::size_t points = std::min(times * m[s], n_);
      wanted[s] = char(points != points_[s] || !is_settled(s));
      if (wanted[s] == 0) continue;
      points_[s] = points;
      window_[s] = sigma[s];
      from_[s] = places_.at()[s];
    }
    places_.renew(fits_, wanted, points_, window_);
    return wanted;
  }

  /// Whether a site hears anything that is new.
  bool any_of_group(std::size_t s, const std::vector<char>& flags) const {
    return std::any_of(group_[s].begin(), group_[s].end(),
                       [&](const Neighbor& q) { return flags[q.index] != 0; });
  }

  /// Whether the window and the place are about as they were at the last fit. A place that moves across the
  /// surface changes the square of its patch's radius, which is sigma^2 and more, by that of the move.
  bool is_settled(std::size_t s) const {
    const double last = window_[s];
    return sigma[s] <= kSettled * last && last <= kSettled * sigma[s] &&
           (places_.at()[s] - from_[s]).squaredNorm() <= (kSettled - 1) * last * last;
  }

  /// Whether the window of a place that fits speak for is still too narrow. In one sheet it opens by less
  /// every round, once it is not full. Where a window far wider than the start's opens by more again before
  /// it has settled, another sheet comes in.
  bool opens_on(std::size_t s) {
    const double least = least_opened_by_[s], times = sigma[s] / window_[s];
    least_opened_by_[s] = std::min(least, std::max(1.0, times));
    const bool still_opens = least > kSettled && least * least < kFilled;
    if (window_[s] > kMuchLouder * start_ && still_opens && times > kSameNoise * least)
      sigma[s] = views[s].sheet = window_[s];
    return sigma[s] > kSettled * window_[s];
  }

  /// Widens the window of a place that no fit speaks for and that sees one sheet. \param full of those
  /// around, as kFilled
  void open_window(std::size_t s, double full) {
    if (full > kFilled)
      sigma[s] =
          std::min(at_most(s, 1), std::max(kNarrowestWindow * views[s].open, std::sqrt(full) * window_[s]));
    if (!loud_part_) return;
    if (is_plainly_louder(s)) sigma[s] = views[s].plain;
    // Where most of the places around have opened theirs, these are not full any more, and this one is late.
    std::vector<double> windows = around(group_[s], window_, kSmallestGroup);
    sigma[s] = std::max(sigma[s], std::min(at_most(s, 1), quantile(windows, 0.5)));
  }

  /// Than its window. Two sheets that scatter twice as much as one would be seen as two.
  bool is_plainly_louder(std::size_t s) const { return views[s].plain > kLouder * sigma[s]; }

  /// Whether no second sheet is beyond the window, nor an edge. Where the search took few points, places show
  /// a little more or less by chance.
  bool all_seen(std::size_t s) const {
    const double held = views[s].held;
    return held > 0 && held < kGrowthOfNoise * sigma[s] &&
           (deep_ || held * held > kDiffers * start_ * start_);
  }

  /// Sets sigma and whether it is of this place; returns that. Where no fit within windows says anything but
  /// two sheets are seen, the noise is what each of them shows, if that is less than the start. \param all
  /// fits to `times` m points
  bool hear_at(std::size_t s, const std::vector<Said>& all, std::size_t times) {
    const std::vector<Said> near = around(group_[s], all, kSmallestGroup), wide = around(group_[s], all);
    const auto saying = [](const std::vector<Said>& fits) {
      return double(std::count_if(fits.begin(), fits.end(), [](const Said& fit) { return fit.freedom > 0; }));
    };
    double variance = mean_variance(wide, kTypical);
    speaks[s] = char(variance > 0 && saying(wide) >= kLeastSpeaking * double(wide.size()));
    if (wide.size() > kSmallestGroup && saying(near) >= kLeastSpeaking * double(kSmallestGroup))
      if (const double of_near = mean_variance(near, kTypical); of_near > kDiffers * variance)
        variance = of_near;
    if (speaks[s] != 0)
      sigma[s] = std::min(at_most(s, times), std::sqrt(variance));
    else if (views[s].sheet < start_)
      sigma[s] = floor[s] = views[s].sheet;  // also below rounding, which looks like sheets
    return speaks[s] != 0;
  }

  /// What a window around `times` m points may show: what is seen without one, which grows inside a slab of
  /// noisy points as their ball does, and of two sheets that of each. More is an edge or a second sheet that
  /// a wider window has let in, and the next one would let in more.
  double at_most(std::size_t s, std::size_t times) const {
    const double balls = std::cbrt(std::max(1.0, double(times * m[s]) / double(kNeighbourhood)));
    const SiteView& view = views[s];
    return std::min(view.sheet,
                    std::max(start_, kSameNoise * std::min(view.most, kOfTheSlab * balls * view.slab)));
  }

  /// Takes more points where their ball is narrow for the window, as search_noise does for the whole cloud.
  /// False if they are enough.
  bool widen(std::size_t s, double radius) {
    if (narrow_[s] == 0) narrow_[s] = radius * std::sqrt(double(kNarrowestPatch) / double(m[s]));
    const double reach = scatter_reach(sigma[s], narrow_[s]);
    if (!(radius < 0.97 * reach) || m[s] >= widest_) return false;
    const double more = std::clamp(reach * reach / (radius * radius), 1.25, 2.0);
    m[s] = std::min(widest_, std::size_t(more * double(m[s])));
    return true;
  }

  std::size_t n_;  ///< points of the cloud
  const Context& context_;
  Places places_;  ///< the sites, which move to the surface
  SiteGroups group_;
  std::vector<double> narrow_;       ///< radius of the ball of the fewest neighbours; 0: not asked for yet
  std::vector<Scatter> fits_;        ///< the last of each site, with ...
  std::vector<std::size_t> points_;  ///< ... so many points, ...
  std::vector<double> window_;       ///< ... this window ...
  Positions from_;                   ///< ... around this place
  std::vector<double> least_opened_by_;  ///< of the rounds: times that the window of each was wider after it
  std::size_t widest_;
  double start_;            ///< world units
  bool loud_part_ = false;  ///< whether a part of the cloud is plainly louder than the start
  bool deep_;               ///< NoiseStart::fills_nearest

 public:
  std::vector<std::size_t> m;
  std::vector<double> sigma;  ///< around each site; where it does not speak and sees no sheet, as before
  std::vector<double> floor;
  std::vector<char> speaks;
  std::vector<SiteView> views;  ///< without windows
};

}  // namespace

NoiseSites listen(const SpatialIndex& index, Positions at, const NoiseStart& start, const DepthSteps* steps,
                  const Context& context) {
  NoiseSites sites;
  sites.in_steps = steps != nullptr;
  sites.at = std::move(at);
  Listener listener(index, sites.at, start, steps, context);
  for (int round = 0; round < kOpeningRounds && listener.open_windows(); ++round)
    ;
  for (int round = 0; round < 3; ++round) listener.hear(1, true);
  sites.volume = listener.silence_volumes();
  const std::vector<double> windows = listener.sigma;
  sites.fits = listener.hear(1, false);
  for (std::size_t s = 0; s < windows.size(); ++s)
    sites.full.push_back(char(sites.fits[s].within > kFilled * windows[s] * windows[s]));
  const std::vector<double> per_root = listener.per_root(sites.fits);
  sites.area = areas(per_root);
  sites.per_root = listener.medians_around(per_root);
  sites.sigma = listener.sigma;
  sites.speaks = listener.speaks;
  sites.floor = listener.floor;
  for (const SiteView& view : listener.views) {
    sites.two_sheets.push_back(char(view.sheet != SiteView::kNone));
    sites.open.push_back(view.own);
    sites.most.push_back(view.most);
    sites.told.push_back(char(view.told));
    sites.plain.push_back(char(view.plain > 0));
    sites.turned.push_back(char(view.turned));
    sites.shared.push_back(view.shared);
  }
  for (int round = 0; round < 2; ++round) listener.hear(2, false);

  sites.shape.assign(sites.at.size(), 0);
  for (std::size_t s = 0; s < sites.at.size(); ++s) {
    const double a = sites.sigma[s] * sites.sigma[s];
    const bool narrow = listener.m[s] == kNarrowestPatch;
    const double of_the_slab = narrow ? 1 : kOfTheSlab, least = narrow ? kLeastNarrow : kLeastWide;
    const double growth = std::max(0.0, listener.sigma[s] * listener.sigma[s] - of_the_slab * a);
    const double floor = sites.floor[s];
    const double left = std::max({least * a, a - growth / (start.shape_grows - 1), floor * floor});
    if (a > 0) sites.shape[s] = std::max(0.0, 1 - left / a);
    sites.sigma[s] = std::sqrt(left);
    if (floor > 0) sites.speaks[s] = 1;
  }
  return sites;
}

}  // namespace rfsmooth::rfs_mesh
