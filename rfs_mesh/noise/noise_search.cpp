#include "rfs_mesh/noise/noise_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/fit/flattest_slab.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/narrow_kernel.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the development shapes with noise of 0.1 to 4 spacings, Gaussian and along the ray
// (tests/bench/noise).
constexpr std::size_t kSearchSites = 500;
constexpr double kFlat = 2;  // sigma: the least radius of a patch
constexpr std::size_t kSites = 2000, kFewestSites = 250;
constexpr std::size_t kWork = 100000;  // sites x m

// Of the breadth: 1 in a disk, a quarter in a strip twice as long as wide. Scans have 0.56 and more.
constexpr double kSurface = 0.4;

/// At every fourth of the places.
double median_radius_at(const Places& places, std::size_t m) {
  Positions fourth;
  for (std::size_t s = 0; s < places.size(); s += 4) fourth.push_back(places.at()[s]);
  return median_radius(places.index(), fourth, m);
}

/// Sigma of the normal distribution of which a window of 3 `window` shows a deviation of `seen`.
double open_window(double window, double seen) {
  const double inside = variance_inside(kScatterWindow);
  double wider = 1;
  while (wider < 1.7 && seen > window * wider * std::sqrt(variance_inside(kScatterWindow / wider) / inside))
    wider += 0.005;
  return wider * window;
}

/// What the calmer fifth of the places shows without a window: more than the noise where there is shape, so a
/// bound. `narrowest`: fewer points are no piece of a surface. `layers`: as of flattest_slab.
double bound(Places& places, std::size_t narrowest, double layers) {
  const auto see = [&](std::size_t m) {
    const std::vector<Scatter> all = places.fits(m);
    std::vector<Weighed> seen = comparable(all, areas(all), kCalmFifthDeviate);
    if (seen.empty()) return NoiseScale();
    return NoiseScale{std::sqrt(quantile(seen, kCalmFifth)), m, quantile_of(all, 0.5, &Scatter::radius)};
  };
  return flattest_slab(std::max(narrowest, kNeighbourhood), places.index().points().size(), see, layers)
      .sigma;
}

/// Where second sheets are as near as the neighbours nearly everywhere, fits without a window tell their
/// distance. So windows from an eighth of that on are tried: the first that a calm quarter of the cloud fills
/// no wider than it is. Not of places whose points are a strip: a plane through a few rings of a laser turns
/// about them to pass through the noise. \param sure no narrower windows.
double lowest(Places& places, std::size_t m, double sigma, double sure) {
  constexpr double kStep = 1.3;
  for (double window = std::max(sure, kNarrowestWindow * sigma); window < 0.8 * sigma; window *= kStep) {
    std::vector<Scatter> all = places.fits(m, window);
    const std::vector<double> area = areas(all);
    double saying = 0, whole = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].breadth < kSurface) all[i].freedom = 0;
      whole += area[i];
      if (says(all[i])) saying += area[i];
    }
    const double share = kCalmPlaces * whole;
    if (saying < share) continue;
    const double seen = std::sqrt(mean_variance(all, share / saying, kCalmDeviate));
    if (seen <= kSameNoise * window) return seen;
  }
  return sigma;
}

/// Whether planes through m points are those through four times as many, around which a ball is twice as
/// wide. \param all the fits to m points, without windows.
bool same_planes(Places& places, const std::vector<Scatter>& all, std::size_t m) {
  constexpr std::size_t kTwiceAsWide = 4;
  constexpr double kByChance = 0.5;  // the median cosine of the angle between two random lines
  if (kTwiceAsWide * m > places.index().points().size()) return true;
  const std::vector<Scatter> wide = places.fits(kTwiceAsWide * m);
  std::vector<double> cosines;
  for (std::size_t s = 0; s < all.size(); ++s) cosines.push_back(std::abs(all[s].normal.dot(wide[s].normal)));
  return quantile(cosines, 0.5) >= kByChance;
}

/// Sets the least m of which the neighbourhoods are pieces of a surface, and the m to start from. The rings
/// of a spinning laser and the terraces of depths in steps are lines while m is small, and a quadric follows
/// a line wherever it goes. Noise that carries points across such a line farther than they are from each
/// other makes a broad strip of it, that nothing scatters about; but the next lines lie on another plane.
/// Terraces only tell how far points share their rounding: there the search starts from few.
/// `all`: the fits at the narrowest m, without windows.
void find_surface(Places& places, std::vector<Scatter> all, bool terraces, NoiseStart& start) {
  const auto breadth = [&] { return quantile_of(all, 0.5, &Scatter::breadth); };
  std::size_t m = start.piece;
  bool lines = breadth() < kLine;
  while (2 * m <= widest_scatter(places.index()) &&
         (breadth() < kSurface || !(terraces || same_planes(places, all, m)))) {
    m *= 2;
    all = places.fits(m);
    // Twice as many are nearer to a line than to a surface. Lines that are closer to each other are connected
    // across, and a surface to every stage.
    if (m == 2 * kNarrowestPatch) lines = lines && breadth() * breadth() < kLine * kSurface;
  }
  if (breadth() < kSurface) return;  // a lone line has no other to reach across to
  start.piece = m;
  start.on_lines = lines;
  if (!terraces && !lines) start.m = m;
}

/// Ever wider windows, up to the bound: sets sigma to the first that is as wide as what it shows, and m to
/// the points of a ball that holds it. The places go to the surface. \param narrow radius of the ball of the
/// least m.
void open_windows(Places& places, double narrow, NoiseStart& start) {
  constexpr double kTooNarrow = 1.35;  // a window this much smaller than what it shows shows too little
  const std::size_t widest = widest_scatter(places.index());
  double said = 0;
  while (start.sigma > start.least) {
    const double reach = scatter_reach(start.sigma, narrow);
    while (5 * start.m / 4 <= widest && median_radius_at(places, start.m) < 0.97 * reach)
      start.m = 5 * start.m / 4;
    const std::vector<Scatter> all = places.fits(points_to_fit(places, start), start.sigma);
    places.move_to_feet(all);
    const double seen = std::sqrt(mean_variance(all, kCalmPlaces, kCalmDeviate)), ratio = seen / start.sigma;
    if (said > 0 && seen > kSameNoise * said) {  // it grows with the neighbourhood: that is shape
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
    if (!(ratio >= kSettled)) break;
  }
}

}  // namespace

double median_radius(const SpatialIndex& index, const Positions& at, std::size_t m) {
  std::vector<Neighbor> near;
  std::vector<double> radii;
  for (const Eigen::Vector3d& p : at) {
    index.nearest(p, int(m), near);
    radii.push_back(std::sqrt(near.back().squared_distance));
  }
  return quantile(radii, 0.5);
}

std::size_t widest_scatter(const SpatialIndex& index) {
  return std::clamp(index.points().size() / kShareOfCloud, kNarrowestPatch, kWidestFit);
}

std::vector<LocalSteps> steps_at(const Places& places, const DepthSteps* steps) {
  std::vector<LocalSteps> found(places.size());
  if (steps == nullptr) return found;
  for_each_index(
      places.context(), found.size(), [&](std::size_t i) { found[i] = steps->at(places.at()[i]); }, 64);
  return found;
}

std::vector<double> rounding_at(const std::vector<LocalSteps>& steps, const std::vector<Scatter>& all) {
  std::vector<double> rounding;
  for (std::size_t i = 0; i < all.size(); ++i) rounding.push_back(steps[i].sigma(all[i].normal));
  return rounding;
}

double variance_of_steps(const std::vector<double>& rounding, const std::vector<Scatter>& all) {
  const std::vector<double> area = areas(all);
  std::vector<Weighed> variances;
  for (std::size_t i = 0; i < all.size(); ++i) variances.push_back({rounding[i] * rounding[i], area[i]});
  return quantile(variances, kCalmPlaces);
}

double two_depths(double rounding) {
  return std::sqrt(3.0) * rounding;  // 1 / 2 of a step over 1 / sqrt(12)
}

bool are_two_depths(double variance, double rounding) {
  return variance <= std::pow(kSameNoise * two_depths(rounding), 2);
}

double scatter_reach(double sigma, double narrow) {
  return std::hypot(kScatterWindow * sigma, std::max(0.9 * narrow, kFlat * sigma));
}

Places search_places(const SpatialIndex& index, const Context& context) {
  return {index, sample(index.points(), kSearchSites), 2 * kNarrowestPatch, context};
}

Positions listening_places(const Positions& places, std::size_t m) {
  return sample(places, std::clamp(kWork / m, kFewestSites, kSites));
}

std::vector<std::size_t> points_to_fit(Places& places, const NoiseStart& start) {
  std::vector<std::size_t> points(places.size(), start.m);
  if (!start.on_lines) return points;
  const std::vector<Scatter> few = places.fits(kNarrowestPatch);
  for (std::size_t s = 0; s < points.size(); ++s)
    if (!(few[s].breadth < kLine)) points[s] = std::max(points[s], 2 * kNarrowestPatch);
  return points;
}

NoiseStart search_noise(Places& places, const DepthSteps* steps, double rounding) {
  NoiseStart start;
  std::vector<Scatter> all = places.fits(start.m);
  find_surface(places, all, steps != nullptr && !steps->on_shells(), start);
  if (start.m > kNarrowestPatch || start.on_lines) all = places.fits(points_to_fit(places, start));
  const double narrow = median_radius_at(places, start.m);
  start.least = std::max(1e-9 * narrow, steps == nullptr ? 0 : steps->rounding());
  start.sigma = std::sqrt(mean_variance(all, kCalmPlaces, kCalmDeviate));
  // Of coordinates that are rounded a narrower window holds those alone that are rounded alike.
  const double rounded = kSameNoise * rounding / kScatterWindow;
  if (steps != nullptr)
    start.of_steps = std::sqrt(variance_of_steps(rounding_at(steps_at(places, steps), all), all));
  const double sure = std::min(start.sigma, std::max(rounded, start.of_steps));
  start.most = kSameNoise * bound(places, start.m, two_depths(start.of_steps));
  // Lines are no sheets, and a window narrow enough finds some that are exact. Nor are steps normal noise.
  const bool surface = start.piece == kNarrowestPatch;
  const std::optional<NoiseInKernels> read =
      surface && !start.on_lines && steps == nullptr
          ? noise_in_kernels(places.index(), start.most, places.context())
          : std::nullopt;
  start.in_kernels = read.has_value();
  if (read) start.most = std::min(start.most, kSameNoise * read->bound);
  if (read && read->sigma) {
    start.sigma = std::min(*read->sigma, start.most);
  } else if (surface) {
    start.sigma = lowest(places, start.m, start.sigma, sure);
  }
  Positions where_they_were = places.at();
  open_windows(places, narrow, start);
  places.move_to(std::move(where_they_were));
  return start;
}

}  // namespace rfsmooth::rfs_mesh
