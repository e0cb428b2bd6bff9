#include "rfs_mesh/noise/noise.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/noise/noise_field.h"
#include "rfs_mesh/noise/shared_noise.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the development shapes with noise of 0.1 to 4 spacings, Gaussian and along the ray
// (tests/bench/noise).
constexpr std::size_t kFewestPoints = 25;
constexpr int kMostLouder = 2;     // parts, one louder than the other
constexpr double kNothing = 1e-3;  // of the figure: what is calmer is so in name only
// The quantile of sites that is the figure: at m = 16 noise may be below the detail.
constexpr double kFigureNarrow = 0.4, kFigureWide = 0.45;
// Where hardly a site speaks, most of the cloud is rough, and what does speak there is half roughness.
constexpr double kFewSpeak = 0.1, kFigureOfFew = 0.2;
constexpr double kLittleShape = 0.25;  // more of it makes places differ that are as noisy
constexpr std::size_t kBlend = 4;      // sites that a point takes the mean of
constexpr std::size_t kSpacingSites = 4000, kSpacingPoints = 16;

/// Root mean square of the values within a factor of `typical`; of noise that varies a little over the cloud,
/// as along a ray, the mean says more than a quantile.
double mean_of_alike(const std::vector<Weighed>& values, double typical) {
  constexpr double kAlike = 1.4;
  double sum = 0, weights = 0;
  for (const Weighed& v : values) {
    if (v.value >= kAlike * typical || typical >= kAlike * v.value) continue;
    sum += v.weight * v.value * v.value;
    weights += v.weight;
  }
  return weights > 0 ? std::sqrt(sum / weights) : typical;
}

/// The sites nearest to each of a few points that lie together: searched once for all of them.
class SitesAround {
 public:
  explicit SitesAround(const SpatialIndex& sites) : sites_(sites) {}

  /// Finds those that may be among the `kBlend` nearest of any of the points.
  void prepare(const Eigen::Vector3d* points, std::size_t count) {
    Eigen::Vector3d low = points[0], high = points[0];
    for (std::size_t i = 1; i < count; ++i) {
      low = low.cwiseMin(points[i]);
      high = high.cwiseMax(points[i]);
    }
    const Eigen::Vector3d centre = (low + high) / 2;
    sites_.nearest(centre, int(kBlend), around_);
    // A point is at most half a diagonal from the centre, and so much farther from each of its nearest.
    constexpr double kRounding = 1 + 1e-9;
    const double reach = std::sqrt(around_.back().squared_distance) + (high - low).norm();
    sites_.within(centre, kRounding * reach, around_);
  }

  /// The mean of the values at the sites nearest to one of the points.
  double mean(const Eigen::Vector3d& p, const std::vector<double>& values) {
    if (around_.size() > kMost) {
      sites_.nearest(p, int(kBlend), near_);
    } else {
      near_.resize(around_.size());
      for (std::size_t k = 0; k < around_.size(); ++k)
        near_[k] = {around_[k].index, squared_distance(p, sites_.points()[around_[k].index])};
      const std::size_t kept = std::min(kBlend, near_.size());
      std::partial_sort(near_.begin(), near_.begin() + std::ptrdiff_t(kept), near_.end());
      near_.resize(kept);
    }
    double sum = 0;
    for (const Neighbor& q : near_) sum += values[q.index];
    return sum / double(near_.size());
  }

 private:
  static constexpr std::size_t kMost = 64;  // more are not worth comparing one by one
  const SpatialIndex& sites_;
  std::vector<Neighbor> around_, near_;
};

/// To every point the mean of the values at the sites nearest to it.
std::vector<double> blend(const SpatialIndex& sites, const std::vector<double>& values,
                          const Positions& points, const Context& context) {
  std::vector<double> local(points.size(), values.front());
  if (std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); })) return local;
  constexpr std::size_t kTogether = 64;  // along a Morton curve they lie together
  for_blocks(context, points.size(), 16 * kTogether, [&](std::size_t begin, std::size_t end) {
    SitesAround around(sites);
    for (std::size_t i = begin; i < end; ++i) {
      if ((i - begin) % kTogether == 0) around.prepare(points.data() + i, std::min(kTogether, end - i));
      local[i] = around.mean(points[i], values);
    }
  });
  return local;
}

/// What was measured in a part of the cloud.
struct Part {
  std::size_t m = kNarrowestScatter;
  double sigma = 0, shape = 0, shared = 1;
  double least = 0;  ///< what counts as zero
  NoiseSites sites;
  std::vector<double> local;  ///< by site, world units
};

/// The figure of a part from what its sites say.
void sum_up(const NoiseStart& start, Part& part) {
  std::vector<Weighed> heard, shape;
  double all = 0, saying = 0;
  for (std::size_t s = 0; s < part.sites.at.size(); ++s) {
    all += part.sites.area[s];
    if (!part.sites.speaks[s]) continue;
    saying += part.sites.area[s];
    heard.push_back({part.sites.sigma[s], part.sites.area[s]});
    if (part.sites.sigma[s] > start.least) shape.push_back({part.sites.shape[s], part.sites.area[s]});
  }
  double share = start.m == kNarrowestScatter ? kFigureNarrow : kFigureWide;
  if (saying < kFewSpeak * all) share = kFigureOfFew;
  part.sigma = heard.empty() ? start.sigma : quantile(heard, share);
  part.shape = shape.empty() ? 0 : quantile(shape, 0.5);
  if (start.m > kNarrowestScatter && part.shape < kLittleShape) part.sigma = mean_of_alike(heard, part.sigma);
  if (part.sigma <= start.least) part.sigma = 0;
  part.sigma = std::min(part.sigma, start.most);  // the windows let a second sheet in nearly everywhere
}

/// The noise around some places of the cloud.
Part measure_part(const SpatialIndex& index, const Positions& where, const DepthSteps* steps,
                  const Context& context) {
  Part part;
  const Positions places = search_places(where);
  NoiseStart start = search_noise(index, places, context);
  part.least = start.least;
  part.shared = double(start.narrowest) / double(kNarrowestScatter);
  if (!(start.least > 0)) return part;
  const SharedNoise shared = find_shared_noise(index, places, start, steps, context);
  if (shared.points > 1) {
    start.sigma = shared.sigma;
    start.m = shared.m;
    start.shape_grows = kGrowthOfSmoothShape;
    start.most = std::max(start.most, shared.sigma);
    part.shared = std::max(part.shared, shared.points);
  }
  part.m = start.m;
  part.sites = listen(index, listening_places(where, start.m), start, steps, context);
  sum_up(start, part);
  part.local.assign(part.sites.at.size(), 0);
  if (!(part.sigma > 0)) return part;
  part.local = relative_noise(part.sites, part.sigma, context);
  for (double& v : part.local) v *= part.sigma;
  return part;
}

/// Whether the scatter at the places is noise: that grows less with the neighbourhood than edges do, of which
/// twice the points see twice the variance.
bool is_noise(const SpatialIndex& index, const Positions& places, double sigma, std::size_t m,
              const Context& context) {
  constexpr double kMostGrowth = 1.75, kDeviateOfHalf = 0;
  double seen[2] = {};
  for (int wide = 0; wide < 2; ++wide) {
    const std::vector<double> open(places.size(), 0);
    const std::vector<Scatter> all = fits(index, places, std::size_t(wide + 1) * m, open, context);
    std::vector<Weighed> variances = comparable(all, areas(all), kDeviateOfHalf);
    if (variances.empty()) return false;
    seen[wide] = quantile(variances, 0.5);
  }
  return seen[0] > sigma * sigma / 4 && seen[1] < kMostGrowth * seen[0];
}

/// The part of the cloud that scatters so much more than what was measured that its places said nothing
/// (beyond the window) or something else. Its sigma is zero if there is none.
Part measure_loud(const SpatialIndex& index, const Part& calm, const DepthSteps* steps, double spacing,
                  const Context& context) {
  constexpr double kLeastPart = 0.1, kMuch = 3, kLouder = 2;  // of the area; times the noise of the rest
  constexpr double kMostlyNoise = 0.3;                        // most of s^2 that may be shape
  constexpr std::size_t kAround = 24;
  const Positions& at = calm.sites.at;
  if (at.empty()) return {};
  const std::vector<Scatter> all = fits(index, at, kAround, std::vector<double>(at.size(), 0), context);
  const std::vector<double> areas_of = areas(all);
  const double least = std::max(kMuch * calm.sigma, kNoNoise * spacing);
  Positions where;
  double area = 0, whole = 0;
  for (std::size_t s = 0; s < at.size(); ++s) {
    whole += areas_of[s];
    if (!says(all[s]) || all[s].variance < least * least) continue;
    where.push_back(at[s]);
    area += areas_of[s];
  }
  if (where.size() < kFewestPoints || area < kLeastPart * whole) return {};
  Part loud = measure_part(index, where, steps, context);
  if (!(loud.sigma > kLouder * calm.sigma) || loud.shape > kMostlyNoise) return {};
  if (!is_noise(index, search_places(where), loud.sigma, 2 * loud.m, context)) return {};
  return loud;
}

/// The part's sites say what they heard; others that are at the same places no longer count.
void take_over(const Part& loud, Positions& at, std::vector<double>& local) {
  std::size_t kept = 0, next = 0;
  for (std::size_t s = 0; s < at.size(); ++s) {
    if (next < loud.sites.at.size() && at[s] == loud.sites.at[next]) {
      ++next;
      continue;
    }
    at[kept] = at[s];
    local[kept] = local[s];
    ++kept;
  }
  at.resize(kept);
  local.resize(kept);
  at.insert(at.end(), loud.sites.at.begin(), loud.sites.at.end());
  local.insert(local.end(), loud.local.begin(), loud.local.end());
}

}  // namespace

NoiseField measure_noise(const SpatialIndex& index, const Context& context) {
  const std::size_t n = index.points().size();
  NoiseModel noise;
  noise.spacing = mean_spacing(index, context);
  if (n < kFewestPoints) return spread_noise(noise, index.points(), context);
  Positions at;
  std::vector<double> local;
  const std::optional<DepthSteps> in_steps = find_depth_steps(index.points());
  const DepthSteps* const steps = in_steps ? &*in_steps : nullptr;
  Part part = measure_part(index, index.points(), steps, context);
  if (in_steps) noise.step = in_steps->typical;
  for (int louder = 0;; ++louder) {
    noise.neighbours = part.m;
    noise.shared = part.shared;
    noise.sigma = part.sigma;
    noise.shape = part.shape;
    take_over(part, at, local);
    if (louder == kMostLouder) break;
    Part next = measure_loud(index, part, steps, noise.spacing, context);
    if (!(next.sigma > 0)) break;
    part = std::move(next);
  }
  if (noise.sigma > 0) {
    for (double& v : local) v = std::max(v, kNothing * noise.sigma);
    if (std::all_of(local.begin(), local.end(), [&](double v) { return v == local.front(); })) {
      at.resize(1);
      local.resize(1);
    }
    noise.sites = std::move(at);
    noise.at_sites = std::move(local);
  }
  return spread_noise(std::move(noise), index.points(), context);
}

NoiseField spread_noise(NoiseModel model, const Positions& points, const Context& context) {
  NoiseField noise{std::move(model), {}};
  if (noise.sites.empty())
    noise.local.assign(points.size(), 0);
  else
    noise.local = blend(SpatialIndex(noise.sites, context), noise.at_sites, points, context);
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
