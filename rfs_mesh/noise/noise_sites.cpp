#include "rfs_mesh/noise/noise_sites.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/sample.h"
#include "rfs_mesh/sheets/two_sheets.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the development shapes with noise of 0.1 to 4 spacings, Gaussian and along the ray
// (tests/bench/noise); the plateau's on depths in steps and shared noise (noise_test.cpp), so that it says
// nothing on the clean shapes.
constexpr std::size_t kSites = 2000, kFewestSites = 250;
constexpr std::size_t kWork = 100000;    // sites x m
constexpr std::size_t kGroupWork = 800;  // a fit of many points says much, and reaches far by itself
constexpr std::size_t kSmallestGroup = 12;
constexpr double kDiffers = 1.5;  // of variances of a dozen fits: two standard errors and more
constexpr double kTypical = 0.35, kTypicalDeviate = -0.385;  // the quantile of fits that is typical
constexpr double kMostSpeak = 0.7;                           // of the fits around a site, to be believed
// At m = 16 noise may be below the detail: less of s^2(m) need be noise.
constexpr double kLeastNarrow = 0.4, kLeastWide = 0.5;
// Wider, the ball is still a little too narrow for the slab, and shows that much more at 2 m.
constexpr double kOfTheSlab = 1.07;
// Of eight times the points: inside a thick slab their ball has twice the radius and sees twice the scatter.
constexpr std::size_t kPlateauTo = 8 * kNeighbourhood;
// The residuals within a window show its own variance if they are of a normal distribution that it was made
// for, three times that if they fill it evenly, as those of a far louder one do: the mean of the two factors.
constexpr double kEven = 3, kFilled = 1.73;
// Scatter::middle above which noise so flat is that of no two sheets: nearly that of an even distribution.
constexpr double kMiddleOfSheets = 0.25;
// Points at two depths that follow each other scatter by half a step, and rounding by 1 / sqrt(12) of it.
constexpr double kTwoDepths = 3;
// Coefficients of a quadric.
constexpr double kOfQuadric = 6;
constexpr int kOpeningRounds = 8;  // windows widen by up to 1.7 in each

// Times, from kNeighbourhood to kPlateauTo points: less than this, and scatter is noise; more than that,
// shape.
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

/// The fits of the sites nearest to one, without windows, and what they say together.
struct Around {
  explicit Around(std::vector<Scatter> of_sites) : fits(std::move(of_sites)) {
    constexpr double kLeanByChance = 6 / double(kNeighbourhood);  // of so many normal values, unweighted
    double saying = 0;
    for (const Scatter& fit : fits) {
      if (!says(fit)) continue;
      freedom += fit.freedom;
      flatness += fit.flatness;
      lean += fit.lean - kLeanByChance;
      middle += fit.middle;
      ++saying;
    }
    for (double* const sum : {&freedom, &flatness, &lean, &middle}) *sum /= saying;
  }

  double variance() const { return mean_variance(fits, kTypical, kTypicalDeviate); }
  /// The median of their balls', world units.
  double radius() const {
    std::vector<double> radii;
    for (const Scatter& fit : fits) radii.push_back(fit.radius);
    return quantile(radii, 0.5);
  }

  std::vector<Scatter> fits;
  double freedom = 0, flatness = 0, lean = 0,
         middle = 0;  ///< means; lean: beyond chance; nan: no fit says a thing
};

/// Fits at all sites to so many points, without windows.
struct OpenFits {
  std::size_t points;
  std::vector<Scatter> all;
};

/// Fits at the sites, and what each site's neighbours say together.
class Listener {
 public:
  Listener(const SpatialIndex& cloud, const Positions& at, const NoiseStart& start, const Context& context)
      : n_(cloud.points().size()),
        context_(context),
        places_(cloud, at, std::min(n_, 2 * start.m), context),
        group_(at.size()),
        narrow_(at.size(), 0),
        open_(at.size(), 0),
        sheet_(at.size(), std::numeric_limits<double>::infinity()),
        held_(at.size(), 0),
        seen_(at.size(), std::numeric_limits<double>::infinity()),
        widest_(widest_scatter(cloud)),
        start_(start.sigma),
        on_lines_(start.on_lines),
        deep_(start.m >= kNeighbourhood),
        m(points_to_fit(places_, start)),
        sigma(at.size(), std::max(start.sigma, start.least)),
        most(at.size(), std::numeric_limits<double>::infinity()),
        floor(at.size(), 0),
        told(at.size(), 0),
        speaks(at.size(), 0) {
    const SpatialIndex index(at, context);
    const int group = int(std::clamp(kGroupWork / start.m, kSmallestGroup, 2 * kNeighbourhood));
    for_each_index(
        context, at.size(), [&](std::size_t s) { index.nearest(at[s], group, group_[s]); }, 64);
  }

  /// Looks without windows: sets `open_`, `sheet_`, `seen_`, `most`, `floor` and `told`, and no
  /// window is narrower than the floor, or wider than a sheet.
  void look(const DepthSteps* steps) {
    std::vector<OpenFits> open;
    for (std::size_t points = kNeighbourhood; open.empty() || (points <= kPlateauTo && n_ >= 2 * points);
         points *= 2)
      open.push_back({points, places_.fits(points)});
    const std::vector<Scatter>& few = open.front().all;
    const std::vector<Scatter> none, wide = deep_ ? places_.fits(m.front()) : none;
    const std::vector<Said> said = what_they_say(few, kTypicalDeviate);
    std::vector<double> middle(group_.size(), 1);
    for_each_index(
        context_, group_.size(),
        [&](std::size_t s) {
          open_[s] = std::sqrt(mean_variance(around(s, said, group_[s].size()), kTypical));
          if (!deep_) seen_[s] = open_[s];
          bound(s, deep_ ? wide : few);
          look_for_sheets(s, open, steps, middle[s]);
        },
        64);
    believe_sheets(middle);
    const bool many_there = open.back().points == kPlateauTo;
    for_each_index(
        context_, group_.size(),
        [&](std::size_t s) {
          if (many_there) find_floor(s, few, open.back().all, steps);
          sigma[s] = std::max(floor[s], std::min(sigma[s], sheet_[s]));
        },
        64);
    if (deep_) hold_slabs(few, many_there ? open.back().all : none);
  }

  /// One round that opens windows which are too narrow for their places; false if there are none. A place
  /// far louder than the start fills its window evenly, and keeps so little of the weight that no fit says
  /// anything. Where the second sheet of a wall is cut off, no more does, but the window is not full.
  bool open_windows() {
    const std::vector<Scatter> all = places_.fits(m, sigma);
    const std::vector<Said> said = what_they_say(all, kTypicalDeviate);
    const std::vector<double> before = sigma;
    const double typical_reach = size_where_sparse(reaches(all));
    std::vector<char> opened(group_.size(), 0);
    for_each_index(
        context_, group_.size(),
        [&](std::size_t s) {
          std::vector<double> full, radius;
          for (const Neighbor& q : group_[s]) {
            const double window = before[q.index];
            radius.push_back(all[q.index].radius);
            if (all[q.index].within > 0) full.push_back(all[q.index].within / (window * window));
          }
          if (!hear_at(s, said, 1)) {
            // Nearly nothing around is left within windows made for far calmer places.
            const bool empty = double(full.size()) < (1 - kMostSpeak) * double(group_[s].size());
            const double typical = empty ? kEven : quantile(full, 0.5);
            if (typical > kFilled && !std::isfinite(sheet_[s]))
              sigma[s] = std::min(at_most(s, 1),
                                  std::max(kNarrowestWindow * open_[s], std::sqrt(typical) * before[s]));
            opened[s] = char(sigma[s] > before[s]);
          }
          const double reach = quantile(radius, 0.5);
          const bool all_seen = held_[s] > 0 && held_[s] < kGrowthOfNoise * sigma[s];
          if (sigma[s] > (all_seen ? kSameNoise : kLouder) * start_ ||
              denser(reach / std::sqrt(double(m[s])), typical_reach))
            opened[s] = char(widen(s, reach) || opened[s] != 0);
        },
        64);
    places_.move_to_feet(all);
    return std::find(opened.begin(), opened.end(), 1) != opened.end();
  }

  /// Fits `times` m points with each site's own window and renews `sigma`; `move`: the places go to the
  /// surface. Returns the fits.
  std::vector<Scatter> hear(std::size_t times, bool move) {
    std::vector<std::size_t> points = m;
    for (std::size_t& count : points) count = std::min(times * count, n_);
    std::vector<Scatter> all = places_.fits(points, sigma);
    const std::vector<Said> said = what_they_say(all, kTypicalDeviate);
    for_each_index(
        context_, group_.size(), [&](std::size_t s) { hear_at(s, said, times); }, 64);
    if (move) places_.move_to_feet(all);
    return all;
  }

  /// By site: the radius of its ball over the root of its points, which are not for being more of more
  /// surface. \param all fits to m points
  std::vector<double> reaches(const std::vector<Scatter>& all) const {
    std::vector<double> of;
    for (std::size_t s = 0; s < all.size(); ++s) of.push_back(all[s].radius / std::sqrt(double(m[s])));
    return of;
  }

  /// The medians of these over the sites around each: points at random are denser here and there.
  std::vector<double> medians_around(const std::vector<double>& of_sites) const {
    std::vector<double> medians;
    for (std::size_t s = 0; s < of_sites.size(); ++s) {
      std::vector<double> near = around(s, of_sites, group_[s].size());
      medians.push_back(quantile(near, 0.5));
    }
    return medians;
  }

 private:
  /// Sets sigma and whether it is of this place; returns that. Where no fit within windows says anything but
  /// two sheets are seen, the noise is what each of them shows, if that is less than the start. \param all
  /// fits to `times` m points
  bool hear_at(std::size_t s, const std::vector<Said>& all, std::size_t times) {
    const std::vector<Said> near = around(s, all, kSmallestGroup), wide = around(s, all, group_[s].size());
    const auto saying = [](const std::vector<Said>& fits) {
      return double(std::count_if(fits.begin(), fits.end(), [](const Said& fit) { return fit.freedom > 0; }));
    };
    double variance = mean_variance(wide, kTypical);
    speaks[s] = char(variance > 0 && saying(wide) >= kMostSpeak * double(wide.size()));
    if (wide.size() > kSmallestGroup && saying(near) >= kMostSpeak * double(kSmallestGroup))
      if (const double of_near = mean_variance(near, kTypical); of_near > kDiffers * variance)
        variance = of_near;
    if (speaks[s] != 0)
      sigma[s] = std::min(at_most(s, times), std::sqrt(variance));
    else if (sheet_[s] < start_)
      sigma[s] = floor[s] = sheet_[s];
    return speaks[s] != 0;
  }

  /// What a window around `times` m points may show: what is seen without one, which grows inside a slab of
  /// noisy points as their ball does, and of two sheets that of each. More is an edge or a second sheet that
  /// a wider window has let in, and the next one would let in more.
  double at_most(std::size_t s, std::size_t times) const {
    const double balls = std::cbrt(std::max(1.0, double(times * m[s]) / double(kNeighbourhood)));
    return std::min(sheet_[s],
                    std::max(start_, kSameNoise * std::min(most[s], kOfTheSlab * balls * seen_[s])));
  }

  /// Sets `most` from what the nearest sites see without windows.
  void bound(std::size_t s, const std::vector<Scatter>& open) {
    constexpr double kNearlyAll = 0.75;
    std::vector<double> radius, variance;
    for (std::size_t k = 0; k < std::min(kSmallestGroup, group_[s].size()); ++k) {
      const Scatter& fit = open[group_[s][k].index];
      radius.push_back(fit.radius);
      variance.push_back(fit.variance);
    }
    const double seen = std::sqrt(quantile(variance, kNearlyAll));
    if (seen < kFlatSlab * quantile(radius, 0.5)) most[s] = seen;
  }

  /// Those of the site's nearest, `count` of them at most.
  template <class T>
  std::vector<T> around(std::size_t s, const std::vector<T>& all, std::size_t count) const {
    std::vector<T> near;
    near.reserve(count);
    for (std::size_t k = 0; k < std::min(count, group_[s].size()); ++k)
      near.push_back(all[group_[s][k].index]);
    return near;
  }

  /// What depths in steps add there by their rounding, world units.
  double rounding_around(std::size_t s, const std::vector<Scatter>& all, const DepthSteps& steps) const {
    std::vector<double> sigma_of;
    for (const Neighbor& q : group_[s])
      sigma_of.push_back(steps.sigma(places_.at()[q.index], all[q.index].normal));
    return quantile(sigma_of, 0.5);
  }

  /// Whether that is more than two depths in steps that follow each other scatter by.
  bool exceeds_rounding(double variance, std::size_t s, const std::vector<Scatter>& open,
                        const DepthSteps* steps) const {
    const double rounding = steps == nullptr ? 0 : rounding_around(s, open, *steps);
    return variance > kTwoDepths * rounding * rounding;
  }

  /// Sets `sheet_`, and `middle` to Scatter::middle, where fits without windows show two sheets around,
  /// farther apart than two depths that follow each other; or `floor` if these are layers. A ball narrower
  /// than the sheets are apart holds hardly any of the second one, a wide one bends away with the surface, so
  /// those count that are flattest. What the residuals of mere shape show may be as flat, but grows.
  void look_for_sheets(std::size_t s, const std::vector<OpenFits>& open, const DepthSteps* steps,
                       double& middle) {
    std::vector<Around> seen;
    for (const OpenFits& fits : open) seen.emplace_back(around(s, fits.all, kNeighbourhood));
    const auto grows = [&](std::size_t k) {  // to or from the next, as only shape does
      const std::size_t next = std::min(k + 1, seen.size() - 1);
      return next > 0 && seen[next].variance() > kGrowthOfNoise * kGrowthOfNoise * seen[next - 1].variance();
    };
    std::size_t flattest = 0;
    for (std::size_t k = 1; k < seen.size(); ++k)
      if (!grows(k) && seen[k].flatness < seen[flattest].flatness) flattest = k;
    const bool two = seen[flattest].flatness < kFlatnessOfSheets;
    if (two && exceeds_rounding(seen[flattest].variance(), s, open[flattest].all, steps)) {
      sheet_[s] = noise_of_sheet(seen[flattest]);
      middle = seen[flattest].middle;
    }
    if (on_lines_) return;
    const std::size_t k = two && seen[flattest].lean <= 0 ? flattest : 0;
    if (!are_layers(seen[k], open[k].points) || !exceeds_rounding(seen[k].variance(), s, open[k].all, steps))
      return;
    sheet_[s] = seen_[s] = std::numeric_limits<double>::infinity();
    floor[s] = std::max(floor[s], std::sqrt(seen[0].variance()));
  }

  /// What each of two sheets shows by itself, of fits that hold both; world units.
  static double noise_of_sheet(const Around& around) {
    const double share = share_of_sheet(around.flatness, std::max(0.0, around.lean));
    // The quadric bends to the sheet that happens to have more points here and there, and so spreads what
    // lies between the sheets; by its share of the degrees of freedom.
    const double spread = (1 - share) * kOfQuadric / (around.freedom + kOfQuadric);
    const double least = kNarrowestWindow * kNarrowestWindow;
    return std::sqrt(around.variance() * std::max(least, share - spread));
  }

  /// Forgets `sheet_` if the noise itself is flat, and not empty in its middle. \param middle of each site
  void believe_sheets(const std::vector<double>& middle) {
    double sum = 0, parted = 0;
    for (std::size_t s = 0; s < sheet_.size(); ++s) {
      if (!std::isfinite(sheet_[s])) continue;
      sum += middle[s];
      ++parted;
    }
    if (sum > kMiddleOfSheets * parted)
      std::fill(sheet_.begin(), sheet_.end(), std::numeric_limits<double>::infinity());
  }

  /// Sets `held_`. \param few, many fits without windows to kNeighbourhood and kPlateauTo points
  void hold_slabs(const std::vector<Scatter>& few, const std::vector<Scatter>& many) {
    const auto hold = [&](const std::vector<Scatter>& all) {
      for_each_index(
          context_, group_.size(),
          [&](std::size_t s) {
            if (held_[s] > 0) return;
            const Around nearest(around(s, all, kNeighbourhood));
            const double seen = std::sqrt(nearest.variance());
            if (seen < kFlatSlab * nearest.radius()) held_[s] = seen;
          },
          64);
    };
    constexpr std::size_t kWidest = kPlateauTo * (kPlateauTo / kNeighbourhood);
    if (widest_ >= kNeighbourhood) hold(few);
    if (widest_ >= kPlateauTo) hold(many);
    if (widest_ >= kWidest && std::find(held_.begin(), held_.end(), 0.0) != held_.end())
      hold(Places(places_.index(), places_.at(), kWidest, context_).fits(kWidest));
  }

  /// Whether fits to so many points show two layers that are nearer to each other than their points are, and
  /// no sheets.
  static bool are_layers(const Around& around, std::size_t points) {
    constexpr double kNormalFlatness = 3;
    constexpr double kToNearest = 0.25;  // the mean distance from a random point to its nearest, squared
    if (!(around.flatness < kNormalFlatness)) return false;
    const double lean = std::max(0.0, around.lean), of_sheet = share_of_sheet(around.flatness, lean);
    if (!(of_sheet < share_of_sheet(kFlatnessOfSheets))) return false;
    const double wide = around.radius(), square_of_point = M_PI * wide * wide / double(points),
                 nearest = (lean > 0 ? 1 : kToNearest) * square_of_point;
    return squared_gap(of_sheet, lean) * around.variance() < nearest;
  }

  /// Raises `floor`, sets `told`, from what is seen without windows. What two sheets scatter does not grow,
  /// either.
  void find_floor(std::size_t s, const std::vector<Scatter>& few, const std::vector<Scatter>& many,
                  const DepthSteps* steps) {
    std::vector<double> narrow, wide, radius;
    for (const Neighbor& q : group_[s]) {
      radius.push_back(few[q.index].radius);
      narrow.push_back(few[q.index].variance);
      wide.push_back(many[q.index].variance);
    }
    const double less = std::sqrt(quantile(narrow, kTypical)), seen = std::sqrt(quantile(wide, kTypical));
    if (!std::isfinite(sheet_[s])) floor[s] = std::max(floor[s], plateau(less, seen, quantile(radius, 0.5)));
    told[s] = char(seen < kStops * less);
    // A stack of slices has few depths, too, and none of the scatter.
    if (steps != nullptr) floor[s] = std::max(floor[s], std::min(seen, rounding_around(s, many, *steps)));
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
  Places places_;  ///< the sites, which move to the surface after look()
  std::vector<std::vector<Neighbor>> group_;
  std::vector<double> narrow_;  ///< radius of the ball of the fewest neighbours; 0: not asked for yet
  std::vector<double> open_;    ///< what the fits around show without windows, world units
  std::vector<double> sheet_;   ///< what each of two sheets shows; infinite: there is one
  std::vector<double> held_;    ///< what the first ball shows that holds the slab, without windows; 0: none
  std::vector<double> seen_;    ///< open_ where it bounds what a window may show; infinite: it does not
  std::size_t widest_;
  double start_;  ///< world units
  bool on_lines_;
  bool deep_;  ///< whether the noise is about a spacing or more: its slab is wider than the nearest
               ///< neighbours are

 public:
  std::vector<std::size_t> m;
  std::vector<double> sigma;  ///< around each site; as before where it does not speak
  std::vector<double> most;   ///< infinite: not known
  std::vector<double> floor;
  std::vector<char> told;
  std::vector<char> speaks;
};

}  // namespace

Positions listening_places(const Positions& places, std::size_t m) {
  return sample(places, std::clamp(kWork / m, kFewestSites, kSites));
}

NoiseSites listen(const SpatialIndex& index, Positions at, const NoiseStart& start, const DepthSteps* steps,
                  const Context& context) {
  NoiseSites sites;
  sites.in_steps = steps != nullptr;
  sites.at = std::move(at);
  Listener listener(index, sites.at, start, context);
  listener.look(steps);
  for (int round = 0; round < kOpeningRounds && listener.open_windows(); ++round)
    ;
  for (int round = 0; round < 3; ++round) listener.hear(1, true);
  const std::vector<double> windows = listener.sigma;
  sites.fits = listener.hear(1, false);
  for (std::size_t s = 0; s < windows.size(); ++s)
    sites.cut.push_back(char(sites.fits[s].within > kFilled * windows[s] * windows[s]));
  const std::vector<double> reaches = listener.reaches(sites.fits);
  sites.area = areas(reaches);
  sites.reach = listener.medians_around(reaches);
  sites.sigma = listener.sigma;
  sites.speaks = listener.speaks;
  sites.floor = listener.floor;
  sites.most = listener.most;
  sites.told = listener.told;
  for (int round = 0; round < 2; ++round) listener.hear(2, false);

  sites.shape.assign(sites.at.size(), 0);
  for (std::size_t s = 0; s < sites.at.size(); ++s) {
    const double a = sites.sigma[s] * sites.sigma[s];
    const bool narrow = listener.m[s] == kNarrowestPatch;
    const double of_the_slab = narrow ? 1 : kOfTheSlab, least = narrow ? kLeastNarrow : kLeastWide;
    const double growth = std::max(0.0, listener.sigma[s] * listener.sigma[s] - of_the_slab * a);
    const double floor = listener.floor[s];
    const double left = std::max({least * a, a - growth / (start.shape_grows - 1), floor * floor});
    if (a > 0) sites.shape[s] = std::max(0.0, 1 - left / a);
    sites.sigma[s] = std::sqrt(left);
    if (floor > 0) sites.speaks[s] = 1;
  }
  return sites;
}

}  // namespace rfsmooth::rfs_mesh
