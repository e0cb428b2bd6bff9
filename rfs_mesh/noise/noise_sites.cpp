#include "rfs_mesh/noise/noise_sites.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the development shapes with noise of 0.1 to 4 spacings, Gaussian and along the ray
// (tests/bench/noise); the plateau's on depths in steps and shared noise (noise_test.cpp), so that it says
// nothing on the clean shapes.
constexpr std::size_t kSites = 2000, kFewestSites = 250;
constexpr std::size_t kWork = 100000;    // sites x m
constexpr std::size_t kGroupWork = 800;  // a fit of many points says much, and reaches far by itself
constexpr std::size_t kSmallestGroup = 12, kLargestGroup = 48;
constexpr double kTypical = 0.35, kTypicalDeviate = -0.385;  // the quantile of fits that is typical
constexpr double kMostSpeak = 0.7;                           // of the fits around a site, to be believed
// At m = 16 noise may be below the detail: less of s^2(m) need be noise.
constexpr double kLeastNarrow = 0.4, kLeastWide = 0.5;
// Wider, the ball is still a little too narrow for the slab, and shows that much more at 2 m.
constexpr double kOfTheSlab = 1.07;
constexpr std::size_t kPlateauFrom = 24, kPlateauTo = 192;

/// What scatter at `few` and `many` neighbours makes sure of. \param radius of the ball of the few.
double plateau(double few, double many, double radius) {
  constexpr double kSame = 1, kSurelyGrows = 1.1, kStops = 1.6, kNeverStops = 1.9, kSure = 0.65;
  constexpr double kFlat = 0.14, kThick = 0.2;
  if (!(few > 0)) return 0;
  const double growth = many / few, share = few / radius;
  const double trust = std::clamp((growth - kSame) / (kSurelyGrows - kSame), 0.0, 1.0) *
                       std::clamp((kNeverStops - growth) / (kNeverStops - kStops), 0.0, 1.0) *
                       std::clamp((kThick - share) / (kThick - kFlat), 0.0, 1.0);
  return trust * std::max(few, kSure * many);
}

/// Fits at the sites, and what each site's neighbours say together.
class Listener {
 public:
  Listener(const SpatialIndex& cloud, const Positions& at, const NoiseStart& start, const Context& context)
      : cloud_(cloud),
        context_(context),
        at_(at),
        centre_(at),
        group_(at.size()),
        kept_(at.size(), KeptNeighbors(std::min(cloud.points().size(), 2 * start.m))),
        sigma(at.size(), std::max(start.sigma, start.least)),
        floor(at.size(), 0),
        speaks(at.size(), 0) {
    const SpatialIndex index(at_, context);
    const int group = int(std::clamp(kGroupWork / start.m, kSmallestGroup, kLargestGroup));
    for_each_index(
        context, at.size(), [&](std::size_t s) { index.nearest(at_[s], group, group_[s]); }, 64);
  }

  /// Sets `floor`; no window is narrower.
  void find_floor(const DepthSteps* steps) {
    if (cloud_.points().size() < 2 * kPlateauTo) return;
    const std::vector<double> open(at_.size(), 0);
    const std::vector<Scatter> many = fits(cloud_, at_, kPlateauTo, open, context_, &kept_);
    const std::vector<Scatter> few = fits(cloud_, at_, kPlateauFrom, open, context_, &kept_);
    for_each_index(
        context_, at_.size(),
        [&](std::size_t s) {
          std::vector<double> narrow, wide, radius, of_steps;
          for (const Neighbor& q : group_[s]) {
            radius.push_back(few[q.index].radius);
            narrow.push_back(few[q.index].variance);
            wide.push_back(many[q.index].variance);
            if (steps != nullptr) of_steps.push_back(steps->sigma(at_[q.index], many[q.index].normal));
          }
          const double seen = std::sqrt(quantile(wide, kTypical));
          floor[s] = plateau(std::sqrt(quantile(narrow, kTypical)), seen, quantile(radius, 0.5));
          // A stack of slices has few depths, too, and none of the scatter.
          if (steps != nullptr) floor[s] = std::max(floor[s], std::min(seen, quantile(of_steps, 0.5)));
          sigma[s] = std::max(sigma[s], floor[s]);
        },
        64);
  }

  /// Fits m points with each site's own window and renews `sigma`; `move`: the places go to the surface.
  /// Returns the fits.
  std::vector<Scatter> hear(std::size_t m, bool move) {
    std::vector<Scatter> all = fits(cloud_, centre_, m, sigma, context_, &kept_);
    for_each_index(
        context_, at_.size(),
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
    return all;
  }

 private:
  const SpatialIndex& cloud_;
  const Context& context_;
  const Positions& at_;
  Positions centre_;
  std::vector<std::vector<Neighbor>> group_;
  std::vector<KeptNeighbors> kept_;

 public:
  std::vector<double> sigma;  ///< around each site; as before where it does not speak
  std::vector<double> floor;
  std::vector<char> speaks;
};

}  // namespace

Positions listening_places(const Positions& places, std::size_t m) {
  return pick(places, std::min(places.size(), std::clamp(kWork / m, kFewestSites, kSites)));
}

NoiseSites listen(const SpatialIndex& index, Positions at, const NoiseStart& start, const DepthSteps* steps,
                  const Context& context) {
  const std::size_t n = index.points().size();
  NoiseSites sites;
  sites.at = std::move(at);
  Listener listener(index, sites.at, start, context);
  listener.find_floor(steps);
  for (int round = 0; round < 3; ++round) listener.hear(start.m, true);
  sites.fits = listener.hear(start.m, false);
  sites.area = areas(sites.fits);
  sites.sigma = listener.sigma;
  sites.speaks = listener.speaks;
  sites.floor = listener.floor;
  for (int round = 0; round < 2; ++round) listener.hear(std::min(n, 2 * start.m), false);

  const double least = start.m == kNarrowestScatter ? kLeastNarrow : kLeastWide;
  sites.shape.assign(sites.at.size(), 0);
  for (std::size_t s = 0; s < sites.at.size(); ++s) {
    const double a = sites.sigma[s] * sites.sigma[s];
    const double of_the_slab = start.m == kNarrowestScatter ? 1 : kOfTheSlab;
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
