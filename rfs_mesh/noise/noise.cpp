#include "rfs_mesh/noise/noise.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/held_out.h"
#include "rfs_mesh/noise/noise_field.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/parts.h"
#include "rfs_mesh/noise/shared/shared_noise.h"
#include "rfs_mesh/noise/sites/loud_places.h"
#include "rfs_mesh/noise/sites/loud_shape.h"
#include "rfs_mesh/noise/steps/rounding.h"
#include "rfs_mesh/noise/steps/voxels.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the development shapes with noise of 0.1 to 4 spacings, Gaussian and along the ray
// (tests/bench/noise).
// The quantile of sites that is the figure: at m = 16 noise may be below the detail.
constexpr double kFigureNarrow = 0.4, kFigureWide = 0.45;
constexpr double kLittleShape = 0.25;  // more of it makes places differ that are as noisy
constexpr std::size_t kBlend = 4;      // sites that a point takes the mean of
// Share of the points that may be nearer than NoiseModel::apart: in clouds that were thinned and merged some
// are.
constexpr double kNearer = 0.01;

/// Root mean square of the values within a factor of `typical`; of noise that varies a little over the cloud,
/// as along a ray, the mean says more than a quantile.
double mean_of_alike(const std::vector<Weighed>& values, double typical) {
  constexpr double kAlike = 1.4;  // with 2 rings of a laser are 40 % worse
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
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < count; ++i) box.extend(points[i]);
    const Eigen::Vector3d centre = box.center();
    sites_.nearest(centre, int(kBlend), around_);
    // A point is at most half a diagonal from the centre, and so much farther from each of its nearest.
    constexpr double kRounding = 1 + 1e-9;
    const double reach = std::sqrt(around_.back().squared_distance) + box.diagonal().norm();
    sites_.within_unsorted(centre, kRounding * reach, around_);
  }

  /// Finds the sites nearest to one of the points.
  void find(const Eigen::Vector3d& p) {
    if (around_.size() > kMost) {
      sites_.nearest(p, int(kBlend), near_);
    } else {
      near_.resize(std::min(kBlend, around_.size()));
      for (Neighbor& q : around_) q.squared_distance = squared_distance(p, sites_.points()[q.index]);
      std::partial_sort_copy(around_.begin(), around_.end(), near_.begin(), near_.end());
    }
  }

  /// The mean of the values at those.
  double mean(const std::vector<double>& values) const {
    double sum = 0;
    for (const Neighbor& q : near_) sum += values[q.index];
    return sum / double(near_.size());
  }

 private:
  static constexpr std::size_t kMost = 64;  // more are not worth comparing one by one
  const SpatialIndex& sites_;
  std::vector<Neighbor> around_, near_;
};

/// Whether all have the same value.
bool is_constant(const std::vector<double>& values, double value) {
  return std::all_of(values.begin(), values.end(), [&](double v) { return v == value; });
}

/// Values of sites, none or one of each, and where those of points go.
struct Blended {
  const std::vector<double>& at_sites;
  std::vector<double>& local;
};

/// To every point the means of the values at the sites nearest to it, which are searched once for all fields.
void blend(const SpatialIndex& sites, const std::vector<Blended>& fields, const Positions& points,
           const Context& context) {
  std::vector<Blended> varying;
  for (const Blended& field : fields) {
    if (field.at_sites.empty()) continue;
    field.local.assign(points.size(), field.at_sites.front());
    if (!is_constant(field.at_sites, field.at_sites.front())) varying.push_back(field);
  }
  if (varying.empty()) return;
  constexpr std::size_t kTogether = 64;  // along a Morton curve they lie together
  for_blocks(context, points.size(), 16 * kTogether, [&](std::size_t begin, std::size_t end) {
    SitesAround around(sites);
    for (std::size_t i = begin; i < end; ++i) {
      if ((i - begin) % kTogether == 0) around.prepare(points.data() + i, std::min(kTogether, end - i));
      around.find(points[i]);
      for (const Blended& field : varying) field.local[i] = around.mean(field.at_sites);
    }
  });
}

/// All hear less by as much as `heard` is above `most`, but no less than they make sure of.
void bound_sites(double heard, double most, NoiseSites& sites) {
  if (!(heard > most)) return;
  for (std::size_t s = 0; s < sites.at.size(); ++s)
    sites.sigma[s] = std::max(sites.floor[s], most / heard * sites.sigma[s]);
}

/// What the calmer fifth hears, what fills a ball included.
double calm_fifth(const NoiseSites& sites) {
  std::vector<Weighed> all;
  for (std::size_t s = 0; s < sites.at.size(); ++s)
    all.push_back({std::max(sites.sigma[s], sites.volume[s]), sites.area[s]});
  return quantile(all, kCalmFifth);
}

/// Whether one figure is that of all: all but the loudest tenth of the sites are less than three times as
/// loud as the calmest tenth, both of those that speak, and if what is seen without windows stands for the
/// others, such as exact ones.
bool is_even(const NoiseSites& sites) {
  const auto even = [](std::vector<Weighed> values) {
    return !values.empty() && quantile(values, 1 - kLeastPart) < kMuchLouder * quantile(values, kLeastPart);
  };
  std::vector<Weighed> speaking, all;
  for (std::size_t s = 0; s < sites.at.size(); ++s) {
    const bool speaks = sites.speaks[s] != 0;
    all.push_back({speaks ? sites.sigma[s] : sites.most[s], sites.area[s]});
    if (speaks) speaking.push_back(all.back());
  }
  return even(std::move(speaking)) && even(std::move(all));
}

/// NoiseModel::spacing_at_sites, also where all are `spacing`.
std::vector<double> spacing_around(const NoiseSites& sites, double spacing) {
  double mean = 0;
  for (const double r : sites.per_root) mean += r / double(sites.per_root.size());
  std::vector<double> around(sites.per_root.size(), spacing);
  for (std::size_t s = 0; s < around.size(); ++s)
    if (denser(sites.per_root[s], mean)) around[s] = spacing * sites.per_root[s] / mean;
  return around;
}

/// The figure, and how much of it shape had, from what the sites say. Of places that have noise, where these
/// are a tenth of the cloud or more: the rest has nothing to smooth. Where hardly a site speaks of
/// those that are not known to be shape, most of the cloud is rough, and what does speak there is half
/// roughness: the calm fifth of it says the figure, but no more than the start, which all of the cloud says:
/// in clean clouds the loudest are all that speaks. Loud places, of wider balls, count more than their area:
/// noise read too small leaves more than noise read too large takes.
void sum_up(const NoiseSites& sites, const std::vector<double>& spacing, const NoiseStart& start,
            NoiseModel& noise) {
  std::vector<Weighed> heard, noisy, shape;
  const std::vector<double> areas_of_balls = areas(sites.fits);
  double all = 0, saying = 0, loud = 0;
  for (std::size_t s = 0; s < sites.at.size(); ++s) {
    const double sigma = sites.sigma[s], area = areas_of_balls[s];
    if (!(sites.volume[s] > 0)) all += area;
    if (!sites.speaks[s]) continue;
    saying += area;
    heard.push_back({sigma, area});
    if (sigma > start.least) shape.push_back({sites.shape[s], area});
    if (!(sigma > kNoNoise * spacing[s])) continue;
    noisy.push_back({sigma, area});
    loud += area;
  }
  if (loud > kLeastPart * saying) heard = std::move(noisy);
  const bool hardly = saying < kLeastPart * all;
  const double of_speaking = start.m == kNarrowestPatch ? kFigureNarrow : kFigureWide;
  noise.sigma =
      heard.empty() ? std::min(start.sigma, start.most) : quantile(heard, hardly ? kCalmFifth : of_speaking);
  if (hardly) noise.sigma = std::min(noise.sigma, start.sigma);
  noise.shape = shape.empty() ? 0 : quantile(shape, 0.5);
  if (start.m > kNarrowestPatch && noise.shape < kLittleShape)
    noise.sigma = mean_of_alike(heard, noise.sigma);
  if (noise.sigma <= start.least) noise.sigma = 0;
}

/// Where the sites begin: at the noise that points have of their own, or at that which they share, of which
/// it tells the model. The points coincide if `least` is 0.
NoiseStart find_start(const SpatialIndex& index, const DepthSteps* steps, double rounding, NoiseModel& noise,
                      const Context& context) {
  Places places = search_places(index, context);
  NoiseStart start = search_noise(places, steps, rounding);
  start.apart = noise.apart;
  noise.rounding = noise.on_grid ? rounding_noise(noise.step) : start.of_steps;
  // Terraces of depths in steps look like lines, too; there the noise is shared.
  if (steps != nullptr && !steps->on_shells()) {
    noise.shared = double(start.piece) / double(kNarrowestPatch);
  } else {
    noise.piece = start.piece;
    noise.on_lines = start.on_lines;
  }
  if (!(start.least > 0)) return start;
  const SharedNoise shared = find_shared_noise(places, start, steps, context);
  if (shared.points > 1) {
    start.sigma = shared.sigma;
    start.m = shared.m;
    start.shape_grows = kGrowthOfSmoothShape;
    start.most = std::max(start.most, shared.sigma);
    noise.shared = std::max(noise.shared, shared.points);
  }
  return start;
}

/// Makes sites of these places, whose noise is of their own.
void enter(LoudPlaces loud, NoiseSites& sites, std::vector<double>& spacing, NoiseModel& noise) {
  noise.at_sites = std::move(loud.at_sites);
  for (std::size_t i = 0; i < loud.at.size(); ++i) {
    sites.at.push_back(loud.at[i]);
    noise.at_sites.push_back(loud.sigma[i]);
    sites.told.push_back(1);
    sites.shared.push_back(1);
    spacing.push_back(spacing[loud.site[i]]);
  }
}

/// Whether noise is told from detail at most sites.
bool is_mostly_told(const NoiseSites& sites) {
  std::size_t most = 0;
  for (std::size_t s = 0; s < sites.plain.size(); ++s) most += std::size_t(sites.tells_noise(s));
  return 2 * most > sites.plain.size();
}

/// Sets told_at_sites. So little noise that it may be detail is told at all sites or at none: at all where
/// most of them tell it and it is more than rounding.
void tell(const NoiseSites& sites, double rounding, NoiseModel& noise) {
  const bool little = noise.sigma <= kNoNoise * noise.spacing;
  if (little && noise.sigma > rounding && is_mostly_told(sites))
    noise.told_at_sites.assign(sites.told.size(), 1);
  else if (!little && std::find(sites.told.begin(), sites.told.end(), 1) != sites.told.end())
    noise.told_at_sites.assign(sites.told.begin(), sites.told.end());
}

/// Fills the model's figures and sites.
void measure(const SpatialIndex& index, const DepthSteps* steps, double rounding, NoiseModel& noise,
             const Context& context) {
  // What is on a grid may be exact, as stairs are: it makes sure of no noise.
  const NoiseStart start = find_start(index, noise.on_grid ? nullptr : steps, rounding, noise, context);
  if (!(start.least > 0)) return;
  NoiseSites sites = listen(index, listening_places(index.points(), start.m), start, steps, context);
  silence_loud_shape(sites, context);
  // Where windows let a second sheet in nearly everywhere, the calmer fifth, too, hears more than it shows
  // without one or than kernels read; where they do at most places, the figure is more than kernels read.
  bound_sites(calm_fifth(sites), std::max(start.most, kNoNoise * noise.spacing), sites);
  std::vector<double> spacing = spacing_around(sites, noise.spacing);
  sum_up(sites, spacing, start, noise);
  const auto bound = [&](double most) {
    bound_sites(noise.sigma, most, sites);
    noise.sigma = std::min(noise.sigma, most);
  };
  if (start.in_kernels) bound(kSameNoise * start.most);
  if (!(noise.sigma > 0)) return;
  // Where there are several sheets at most places, windows let them in. Noise of a part of the cloud or that
  // points do not have of their own is not foretold by a surface; steps and lines are not read in kernels.
  if (start.in_kernels && !noise.on_grid && !is_shared(noise) && is_even(sites)) {
    const std::optional<double> most = held_out_bound(index, noise.sigma, context);
    if (most && noise.sigma > kSameNoise * *most) bound(*most);
  }
  noise.at_sites = relative_noise(sites, noise.sigma, context);
  for (double& v : noise.at_sites) v = noise.sigma * std::max(v, kStays);
  if (!noise.on_grid && noise.piece <= kNarrowestPatch)  // on lines the nearest points tell nothing
    enter(find_loud_places(index, sites, std::move(noise.at_sites), context), sites, spacing, noise);
  noise.sites = std::move(sites.at);
  tell(sites, rounding, noise);
  for (double& shared : sites.shared) shared = std::max(shared, noise.shared);
  if (!is_constant(sites.shared, noise.shared)) noise.shared_at_sites = std::move(sites.shared);
  if (!is_constant(spacing, noise.spacing)) {
    noise.spacing_at_sites = std::move(spacing);
  } else if (is_constant(noise.at_sites, noise.at_sites.front()) && noise.shared_at_sites.empty()) {
    noise.sites.resize(1);
    noise.at_sites.resize(1);
    noise.told_at_sites.resize(is_told(noise) ? 1 : 0);
  }
}

}  // namespace

std::vector<double> NoiseField::strays_beyond(double times, const Context& context) const {
  std::vector<double> of(local.size());
  for_each_index(context, of.size(), [&](std::size_t i) { of[i] = times * stray_beyond(i); });
  return of;
}

NoiseModel measure_noise(const SpatialIndex& index, const Context& context) {
  NoiseModel noise;
  std::vector<double> nearest = nearest_distances(index, context);
  noise.spacing = mean_spacing(nearest, context);
  if (!nearest.empty()) noise.apart = quantile(nearest, kNearer);
  if (index.points().size() <= kNeighbourhood) return noise;
  const double typical = quantile(nearest, 0.5);
  if (const auto voxel = voxel_size(index, typical, context)) noise.apart = std::max(noise.apart, *voxel);
  const double rounding = rounding_of(sample(index.points(), kSampleOfCloud));
  std::optional<DepthSteps> steps = find_depth_steps(index, rounding, typical);
  const std::optional<DepthSteps> grid = find_grid(std::move(nearest), rounding);
  // Before a wall a camera's points are on a grid, too, of its pixels; a grid has few values along some
  // directions, too, no farther from each other.
  if (grid && !(steps && steps->exceed(*grid))) steps = grid;
  if (steps) {
    noise.step = steps->typical();
    noise.on_grid = steps->on_grid();
  }
  measure(index, steps ? &*steps : nullptr, rounding, noise, context);
  return noise;
}

const NoiseModel& known_noise(const SpatialIndex& index, Statistics& whole, const Context& context) {
  if (whole.noise) return *whole.noise;
  measure_parts(index, whole, context);
  if (!whole.noise) whole.noise = measure_noise(index, context);
  return *whole.noise;
}

NoiseField spread_noise(NoiseModel model, const Positions& points, const Context& context) {
  NoiseField noise{std::move(model), {}, {}, {}, {}};
  if (noise.sites.empty()) {
    noise.local.assign(points.size(), 0);
    return noise;
  }
  const SpatialIndex sites(noise.sites, context);
  blend(sites,
        {{noise.at_sites, noise.local},
         {noise.spacing_at_sites, noise.local_spacing},
         {noise.shared_at_sites, noise.local_shared},
         {noise.told_at_sites, noise.local_told}},
        points, context);
  return noise;
}

std::vector<double> measure_spacing(const SpatialIndex& index, const Context& context) {
  const std::size_t n = index.points().size();
  if (n < 2) return std::vector<double>(n, 0);
  const Positions at = listening_places(index.points(), kNeighbourhood);
  std::vector<double> spacing(at.size());
  for_blocks(context, at.size(), 32, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near, next;
    for (std::size_t s = begin; s < end; ++s) {
      index.nearest(at[s], int(kNeighbourhood), near);
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
  std::vector<double> local;
  blend(sites, {{spacing, local}}, index.points(), context);
  return local;
}

}  // namespace rfsmooth::rfs_mesh
