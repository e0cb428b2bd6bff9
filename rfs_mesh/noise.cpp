#include "rfsmooth/rfs_mesh/noise.h"

#include <algorithm>
#include <cmath>

#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/rfs_mesh/scatter.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the development shapes with noise of 0.1 to 4 spacings, Gaussian and along the ray
// (tests/bench/noise).
constexpr std::size_t kSites = 2000, kFewestSites = 250;
constexpr std::size_t kWork = 100000;      // sites x m
constexpr std::size_t kSearchSites = 500;  // while looking for the figure
constexpr std::size_t kFewestPoints = 25;
constexpr std::size_t kNarrowest = 16, kWidest = 2048, kShareOfCloud = 12;  // m; at most n / 12
constexpr double kFlat = 2;                                  // sigma: the least radius of a patch
constexpr double kCalm = 0.25, kCalmDeviate = -0.674;        // the quantile of sites that the search believes
constexpr double kTypical = 0.35, kTypicalDeviate = -0.385;  // and around a site
constexpr double kFarAbove = 4;                              // times the typical variance: does not count
constexpr double kMostSpeak = 0.7;  // of the fits around a site, for it to be believed
// At m = 16 noise may be below the detail: lower sites are the figure, and less of s^2(m) need be noise.
constexpr double kFigureNarrow = 0.4, kFigureWide = 0.45;
constexpr double kLeastNarrow = 0.4, kLeastWide = 0.5;
constexpr std::size_t kSmooth = 24;  // sites whose median is the field
constexpr double kNoSay = 0.07;      // logarithm: less is the measurement's own scatter
constexpr std::size_t kBlend = 4;    // sites that a point takes the mean of
constexpr std::size_t kSpacingSites = 4000, kSpacingPoints = 16;

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The quantile at a standard normal `deviate` of chi-square over its degrees of freedom (Wilson & Hilferty).
double chi_square(double freedom, double deviate) {
  const double v = 2 / (9 * freedom);
  return std::pow(std::max(0.1, 1 - v + deviate * std::sqrt(v)), 3);
}

/// The mean variance of the fits, without those far above their typical one. Zero if none has anything to
/// say.
double mean_variance(const std::vector<Scatter>& all, double share, double deviate) {
  std::vector<double> comparable;
  for (const Scatter& s : all)
    if (s.freedom > 0.5) comparable.push_back(s.variance / chi_square(s.freedom, deviate));
  if (comparable.empty()) return 0;
  const double typical = quantile(comparable, share);
  double sum = 0, weights = 0;
  for (const Scatter& s : all) {
    if (s.freedom <= 0.5 || s.variance > kFarAbove * typical) continue;
    sum += s.freedom * s.variance;
    weights += s.freedom;
  }
  return weights > 0 ? sum / weights : typical;
}

/// `count` points of the cloud, evenly over the indices.
Positions pick(const Positions& points, std::size_t count) {
  Positions picked(count);
  for (std::size_t s = 0; s < count; ++s) picked[s] = points[s * points.size() / count];
  return picked;
}

std::vector<Scatter> fits(const SpatialIndex& index, const Positions& places, std::size_t m,
                          const std::vector<double>& sigma, const Context& context) {
  std::vector<Scatter> all(places.size());
  for_blocks(context, places.size(), 16, [&](std::size_t begin, std::size_t end) {
    ScatterFit fit;
    for (std::size_t s = begin; s < end; ++s) all[s] = fit(index, places[s], m, sigma[s]);
  });
  return all;
}

double median_radius(const SpatialIndex& index, const Positions& places, std::size_t m) {
  std::vector<Neighbor> near;
  std::vector<double> radii;
  for (std::size_t s = 0; s < places.size(); s += 4) {
    index.nearest(places[s], int(m), near);
    radii.push_back(std::sqrt(near.back().squared_distance));
  }
  return quantile(radii, 0.5);
}

/// The figure to start from, and m.
struct Start {
  double sigma = 0, least = 0, most = 0;  ///< least: what counts as zero; most: the bound
  std::size_t m = kNarrowest;
};

/// Sigma of the normal distribution of which a window of 3 `window` shows a deviation of `seen`.
double open_window(double window, double seen) {
  const double inside = variance_inside(kScatterWindow);
  double wider = 1;
  while (wider < 1.7 && seen > window * wider * std::sqrt(variance_inside(kScatterWindow / wider) / inside))
    wider += 0.005;
  return wider * window;
}

/// What the calmer fifth of the places shows without a window: more than the noise where there is shape, so a
/// bound. The neighbourhood doubles until the slab is flat in it, or until shape shows.
double bound(const SpatialIndex& index, const Positions& places, const Context& context) {
  constexpr double kShareOfRadius = 0.18, kGrowthOfNoise = 1.26, kShare = 0.2, kDeviate = -0.84;
  constexpr std::size_t kFirst = 24, kLast = 1536;
  const std::vector<double> none(places.size(), 0);
  double sigma = 0, least = 1;
  for (std::size_t m = kFirst; m <= kLast && m < index.points().size(); m *= 2) {
    std::vector<double> seen, radii;
    for (const Scatter& s : fits(index, places, m, none, context)) {
      radii.push_back(s.radius);
      if (s.freedom > 0.5) seen.push_back(s.variance / chi_square(s.freedom, kDeviate));
    }
    if (seen.empty()) break;
    const double next = std::sqrt(quantile(seen, kShare)), radius = quantile(radii, 0.5);
    if (m > kFirst && next > kGrowthOfNoise * sigma) break;
    if (!(radius > 0) || next < least * radius) {
      least = radius > 0 ? next / radius : 0;
      sigma = next;
    }
    if (least <= kShareOfRadius) break;
  }
  return sigma;
}

/// Where second sheets are as near as the neighbours nearly everywhere, fits without a window tell their
/// distance. So windows from an eighth of that on are tried: the first that a quarter of the places fill no
/// wider than it is.
double lowest(const SpatialIndex& index, const Positions& places, std::size_t m, double sigma,
              const Context& context) {
  constexpr double kFrom = 0.125, kStep = 1.3, kFilled = 1.1, kLeastPlaces = 0.25;
  for (double window = kFrom * sigma; window < 0.8 * sigma; window *= kStep) {
    const std::vector<Scatter> all =
        fits(index, places, m, std::vector<double>(places.size(), window), context);
    const auto saying =
        std::count_if(all.begin(), all.end(), [](const Scatter& s) { return s.freedom > 0.5; });
    const double seen = std::sqrt(mean_variance(all, kCalm, kCalmDeviate));
    if (double(saying) >= kLeastPlaces * double(places.size()) && seen <= kFilled * window) return seen;
  }
  return sigma;
}

Start search(const SpatialIndex& index, const Context& context) {
  constexpr double kTooNarrow = 1.35;  // a window this much smaller than what it shows shows too little
  constexpr double kSettled = 1.03, kGrowing = 1.1;
  constexpr double kAboveBound = 1.15;
  constexpr int kMostSteps = 12;
  const std::size_t n = index.points().size();
  const std::size_t widest = std::clamp(n / kShareOfCloud, kNarrowest, kWidest);
  Start start;
  Positions places = pick(index.points(), std::min(n, kSearchSites));
  std::vector<Scatter> all = fits(index, places, start.m, std::vector<double>(places.size(), 0), context);
  const double narrow = median_radius(index, places, start.m);
  start.least = 1e-9 * narrow;
  start.sigma = std::sqrt(mean_variance(all, kCalm, kCalmDeviate));
  start.sigma = lowest(index, places, start.m, start.sigma, context);
  start.most = kAboveBound * bound(index, places, context);
  double said = 0;
  for (int step = 0; step < kMostSteps && start.sigma > start.least; ++step) {
    const double reach =
        std::hypot(kScatterWindow * start.sigma, std::max(0.9 * narrow, kFlat * start.sigma));
    while (5 * start.m / 4 <= widest && median_radius(index, places, start.m) < 0.97 * reach)
      start.m = 5 * start.m / 4;
    all = fits(index, places, start.m, std::vector<double>(places.size(), start.sigma), context);
    for (std::size_t s = 0; s < places.size(); ++s) places[s] = all[s].foot;
    const double seen = std::sqrt(mean_variance(all, kCalm, kCalmDeviate)), ratio = seen / start.sigma;
    if (said > 0 && seen > kGrowing * said) {  // it grows with the neighbourhood: that is shape
      start.sigma = said;
      break;
    }
    if (seen > start.most) {
      start.sigma = said > 0 ? std::min(said, start.most) : start.most;
      break;
    }
    if (ratio > kTooNarrow) {
      start.sigma = seen;
      continue;
    }
    start.sigma = said = ratio > 1 ? open_window(start.sigma, seen) : seen;
    if (ratio < kSettled) break;
  }
  return start;
}

/// Fits at sites, and what each site's neighbours say together.
class Sites {
 public:
  Sites(const SpatialIndex& index, const Start& start, const Context& context)
      : cloud_(index),
        context_(context),
        at_(pick(index.points(),
                 std::min(index.points().size(), std::clamp(kWork / start.m, kFewestSites, kSites)))),
        centre_(at_),
        index_(at_, context),
        sigma(at_.size(), std::max(start.sigma, start.least)),
        speaks(at_.size(), 0) {
    // A fit of many points has many degrees of freedom, and reaches far by itself.
    const int group = int(std::clamp<std::size_t>(800 / start.m, 12, 48));
    group_.resize(at_.size());
    for_each_index(
        context, at_.size(), [&](std::size_t s) { index_.nearest(at_[s], group, group_[s]); }, 64);
  }

  std::size_t size() const { return at_.size(); }
  const Positions& at() const { return at_; }
  const SpatialIndex& index() const { return index_; }

  /// Fits m points with each site's own window and renews `sigma`; `move`: the places go to the surface.
  void listen(std::size_t m, bool move) {
    const std::vector<Scatter> all = fits(cloud_, centre_, m, sigma, context_);
    for_each_index(
        context_, size(),
        [&](std::size_t s) {
          std::vector<Scatter> around;
          std::size_t saying = 0;
          for (const Neighbor& q : group_[s]) {
            around.push_back(all[q.index]);
            if (around.back().freedom > 0) ++saying;
          }
          const double variance = mean_variance(around, kTypical, kTypicalDeviate);
          speaks[s] = char(variance > 0 && double(saying) >= kMostSpeak * double(around.size()));
          if (speaks[s]) sigma[s] = std::sqrt(variance);
          if (move) centre_[s] = all[s].foot;
        },
        64);
  }

 private:
  const SpatialIndex& cloud_;
  const Context& context_;
  Positions at_, centre_;
  SpatialIndex index_;
  std::vector<std::vector<Neighbor>> group_;

 public:
  std::vector<double> sigma;  ///< around each site; as before where it does not speak
  std::vector<char> speaks;
};

/// The field at the sites: the median around each, relative to the figure, where it means something.
std::vector<double> smooth(const Sites& sites, const std::vector<double>& sigma,
                           const std::vector<char>& speaks, double figure, const Context& context) {
  std::vector<double> field(sites.size(), figure);
  for_each_index(
      context, sites.size(),
      [&](std::size_t s) {
        std::vector<Neighbor> near;
        std::vector<double> around;
        sites.index().nearest(sites.at()[s], int(kSmooth), near);
        for (const Neighbor& q : near)
          if (speaks[q.index]) around.push_back(std::log(std::clamp(sigma[q.index] / figure, 0.2, 3.0)));
        if (around.empty()) return;
        const double d = quantile(around, 0.5);
        if (std::abs(d) > kNoSay) field[s] = figure * std::exp(d - kNoSay * kNoSay / d);
      },
      64);
  return field;
}

/// To every point the mean of the values at the sites nearest to it.
std::vector<double> blend(const SpatialIndex& sites, const std::vector<double>& values,
                          const Positions& points, const Context& context) {
  std::vector<double> local(points.size(), values.front());
  if (std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); })) return local;
  for_blocks(context, points.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near;
    for (std::size_t i = begin; i < end; ++i) {
      sites.nearest(points[i], int(kBlend), near);
      double sum = 0;
      for (const Neighbor& q : near) sum += values[q.index];
      local[i] = sum / double(near.size());
    }
  });
  return local;
}

}  // namespace

NoiseField measure_noise(const SpatialIndex& index, const Context& context) {
  const std::size_t n = index.points().size();
  NoiseField noise;
  noise.local.assign(n, 0);
  if (n < kFewestPoints) return noise;
  const Start start = search(index, context);
  noise.neighbours = start.m;
  if (!(start.least > 0)) return noise;
  Sites sites(index, start, context);
  for (int round = 0; round < 4; ++round) sites.listen(start.m, round < 3);
  const std::vector<double> narrow = sites.sigma;
  const std::vector<char> speaks = sites.speaks;
  for (int round = 0; round < 2; ++round) sites.listen(std::min(n, 2 * start.m), false);

  const bool narrowest = start.m == kNarrowest;
  const double least = narrowest ? kLeastNarrow : kLeastWide;
  std::vector<double> sigma(sites.size()), heard, shape;
  for (std::size_t s = 0; s < sites.size(); ++s) {
    const double a = narrow[s] * narrow[s], growth = std::max(0.0, sites.sigma[s] * sites.sigma[s] - a);
    const double left = std::max(least * a, a - growth);
    sigma[s] = std::sqrt(left);
    if (!speaks[s]) continue;
    heard.push_back(sigma[s]);
    shape.push_back(1 - left / a);
  }
  noise.sigma = heard.empty() ? start.sigma : quantile(heard, narrowest ? kFigureNarrow : kFigureWide);
  noise.shape = shape.empty() ? 0 : quantile(shape, 0.5);
  if (noise.sigma <= start.least) noise.sigma = 0;
  if (!(noise.sigma > 0)) return noise;
  if (noise.sigma > start.most) {  // the windows let a second sheet in nearly everywhere
    for (double& v : sigma) v *= start.most / noise.sigma;
    noise.sigma = start.most;
  }
  noise.local =
      blend(sites.index(), smooth(sites, sigma, speaks, noise.sigma, context), index.points(), context);
  return noise;
}

std::vector<double> measure_spacing(const SpatialIndex& index, const Context& context) {
  const std::size_t n = index.points().size();
  if (n < 2) return std::vector<double>(n, 0);
  const Positions at = pick(index.points(), std::min(n, kSpacingSites));
  std::vector<double> spacing(at.size());
  for_blocks(context, at.size(), 32, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near, next;
    for (std::size_t s = begin; s < end; ++s) {
      index.nearest(at[s], int(kSpacingPoints), near);
      double sum = 0;
      for (const Neighbor& q : near) {
        index.nearest(index.points()[q.index], 2, next);
        // The point itself is one of the two, at distance zero.
        sum += std::sqrt(next.back().squared_distance);
      }
      spacing[s] = sum / double(near.size());
    }
  });
  const SpatialIndex sites(at, context);
  return blend(sites, spacing, index.points(), context);
}

}  // namespace rfsmooth::rfs_mesh
