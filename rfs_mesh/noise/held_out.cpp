#include "rfs_mesh/noise/held_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/noise_search.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on meshes of libcgal-demo beside the development shapes (tests/bench/quality), 10,000 points, noise
// of 1 to 3 %: on the development shapes the bound never acts.
constexpr std::size_t kFold = 5;        // one point of so many is held out; with 8 fewer stacks are told
constexpr std::size_t kLooked = 20000;  // points of larger clouds: with 50,000 stacks are found no better
// Standard errors: twice as many take quadrics that are too wide.
constexpr double kAsLikely = 0.5;
constexpr std::size_t kTried = 12;  // values of s, each kSameNoise times less
using OfEach = std::array<double, kTried>;

/// What the shadows at one m say of the held out points.
struct Likelihood {
  double s = 0;              ///< the best, world units
  double mean = 0;           ///< of the logs
  std::vector<double> logs;  ///< of the density at each held out point, with the best of those tried
};

/// By how many standard errors a is likelier than b.
double likelier(const Likelihood& a, const Likelihood& b) {
  double squares = 0;
  const auto n = double(a.logs.size());
  const double mean = a.mean - b.mean;
  for (std::size_t i = 0; i < a.logs.size(); ++i) squares += std::pow(a.logs[i] - b.logs[i] - mean, 2);
  return squares > 0 ? mean / (std::sqrt(squares) / n) : 0;
}

/// The points that are fitted, and those that are held out.
struct Parts {
  explicit Parts(const Positions& points) {
    const Positions some = sample(points, kLooked);
    for (std::size_t i = 0; i < some.size(); ++i)
      (i % kFold == kFold / 2 ? held_out : fitted).push_back(some[i]);
  }
  Positions fitted, held_out;
};

class HeldOut {
 public:
  HeldOut(const Positions& points, const Context& context)
      : parts_(points),
        index_(parts_.fitted, context),
        near_(index_.nearest(int(kRing), context)),
        spacing_(mean_spacing(parts_.fitted, near_, context)),
        context_(context) {}

  /// The bound, by the quadrics that follow the surface best if its noise is sigma; none: no ball is wide
  /// enough.
  std::optional<double> bound(double sigma) const {
    const Positions places = sample(parts_.fitted, kPlacesOfCloud);
    std::vector<Likelihood> all;
    std::size_t best = 0;
    for (std::size_t m = kNarrowestPatch; m <= widest_scatter(index_); m += m / 2) {
      const double radius = median_radius(index_, places, m);
      Likelihood found = look(m, sigma, radius);
      if (found.s > kThickSlab * radius) continue;
      all.push_back(std::move(found));
      if (all.back().mean > all[best].mean)
        best = all.size() - 1;
      else if (likelier(all[best], all.back()) > kNoiseReach)
        break;  // wider ones are less likely, too
    }
    if (all.empty()) return {};
    std::size_t widest = best;
    for (std::size_t k = best + 1; k < all.size(); ++k)
      if (likelier(all[best], all[k]) <= kAsLikely) widest = k;
    return all[widest].s;
  }

 private:
  Likelihood look(std::size_t m, double sigma, double radius) const {
    const std::vector<double> noise(parts_.fitted.size(), sigma);
    const std::vector<LocalSurface> surfaces = shared_local_surfaces(
        index_, near_, {sigma, m, radius}, noise, {}, std::min(m, kNeighbourhood), context_);
    const Positions at = shadows(surfaces, context_);
    const SpatialIndex on_surface(at, context_);
    OfEach s;
    for (std::size_t k = 0; k < kTried; ++k) s[k] = sigma * std::pow(kSameNoise, 1 - double(k));
    std::vector<OfEach> logs(parts_.held_out.size());
    for_blocks(context_, logs.size(), 16, [&](std::size_t begin, std::size_t end) {
      std::vector<Neighbor> near;
      for (std::size_t i = begin; i < end; ++i)
        logs[i] = logs_at(parts_.held_out[i], on_surface, surfaces, s, near);
    });
    return best_of(logs, s);
  }

  /// The logarithm of the density at x, for each s.
  OfEach logs_at(const Eigen::Vector3d& x, const SpatialIndex& on_surface,
                 const std::vector<LocalSurface>& surfaces, const OfEach& s,
                 std::vector<Neighbor>& near) const {
    constexpr double kNothing = 1e-6;  // of one shadow's: the density where none is near, as of a stray
    on_surface.within_unsorted(x, std::max(kNoiseReach * s[0], kScatterWindow * spacing_), near);
    OfEach density;
    density.fill(kNothing);
    for (const Neighbor& q : near) {
      const double across = (x - on_surface.points()[q.index]).dot(surfaces[q.index].normal),
                   square = across * across,
                   along = (q.squared_distance - square) / (2 * spacing_ * spacing_);
      if (2 * along > kScatterWindow * kScatterWindow) continue;
      for (std::size_t k = 0; k < kTried; ++k) density[k] += std::exp(-along - square / (2 * s[k] * s[k]));
    }
    for (std::size_t k = 0; k < kTried; ++k) density[k] = std::log(density[k] / s[k]);
    return density;
  }

  /// The best s, between those tried at the top of a parabola.
  static Likelihood best_of(const std::vector<OfEach>& logs, const OfEach& s) {
    OfEach sum = {};
    for (const OfEach& l : logs)
      for (std::size_t k = 0; k < kTried; ++k) sum[k] += l[k];
    const auto best = std::size_t(std::max_element(sum.begin(), sum.end()) - sum.begin());
    double beyond = 0;
    if (best > 0 && best + 1 < kTried)
      beyond = (sum[best - 1] - sum[best + 1]) / (2 * (sum[best - 1] - 2 * sum[best] + sum[best + 1]));
    Likelihood found{s[best] * std::pow(kSameNoise, -beyond), sum[best] / double(logs.size()), {}};
    for (const OfEach& l : logs) found.logs.push_back(l[best]);
    return found;
  }

  Parts parts_;
  SpatialIndex index_;
  NeighborTable near_;
  double spacing_;  ///< h
  const Context& context_;
};

}  // namespace

std::optional<double> held_out_bound(const SpatialIndex& index, double sigma, const Context& context) {
  const HeldOut cloud(index.points(), context);
  std::optional<double> bound;
  while (const std::optional<double> next = cloud.bound(sigma)) {
    bound = std::min(*next, bound.value_or(*next));
    if (kSettled * *next >= sigma) break;
    sigma = *next;  // quadrics for so much less noise are others
  }
  return bound;
}

}  // namespace rfsmooth::rfs_mesh
