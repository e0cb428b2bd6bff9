#include "rfs_mesh/noise/shared/shared_noise.h"

#include <algorithm>
#include <cmath>

#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/shared/signs_of_sharing.h"
#include "rfs_mesh/noise/steps/terraces.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the laws of tests/bench/quality (six shapes, 10,000 points) and on the raw scans of
// tests/bench/scans.
constexpr std::size_t kPointsLooked = 500000;  // at each m: of wide places fewer say as much
constexpr std::size_t kInARow = 2;             // the least that is a row
// Of the variance, from m to 2 m: noise that no other shape overtakes grows slower than m.
constexpr double kMostGrowthOfNoise = 2;
// The same of ground, whose roughness has no scale of its own: 2^H, H from 0.5 on (Mandelbrot 1982).
constexpr double kLeastGrowthOfGround = 1.414;
constexpr double kMostlyOwn = 0.5;  // of a variance

/// What calm places show, by the number of neighbours, ascending.
struct Calm {
  std::vector<double> m, seen;        ///< points, variance about a quadric
  std::vector<SignsOfSharing> signs;  ///< of their fits
  std::vector<double> radius;         ///< mean, of their balls
  std::vector<char> two_depths;       ///< are_two_depths, of most of them
  double steps = 0;                   ///< variance that depths in steps make sure of
};

/// Enters what the fits of at most this variance show of how points err. \param rounding of each, by depths
/// in steps
void enter(const std::vector<Scatter>& all, const std::vector<double>& rounding, double variance,
           Calm& calm) {
  std::vector<const Scatter*> of_calm;
  double radius = 0, two_depths = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Scatter& s = all[i];
    if (!says(s) || s.variance > variance) continue;
    of_calm.push_back(&s);
    radius += s.radius;
    two_depths += double(are_two_depths(s.variance, rounding[i]));
  }
  const auto count = double(of_calm.size());
  calm.signs.push_back(signs_of(of_calm));
  calm.radius.push_back(count > 0 ? radius / count : 0);
  calm.two_depths.push_back(char(2 * two_depths > count));
}

Calm look(Places& places, const NoiseStart& start, const DepthSteps* steps, const Context& context) {
  Calm calm;
  const SpatialIndex& index = places.index();
  const std::vector<LocalSteps> steps_there = steps_at(places, steps);
  // Half of what fits take at most: else parts of the cloud are shape.
  const std::size_t last = std::min(widest_scatter(index), index.points().size() / (2 * kShareOfCloud));
  for (std::size_t m = std::max(start.m, start.piece); m <= last; m *= 2) {
    Places fewer(index, sample(places.at(), kPointsLooked / m), 0, context);
    Places& some = fewer.size() < places.size() ? fewer : places;
    const std::vector<Scatter> all = some.fits(m);
    const std::vector<double> area = areas(all);
    std::vector<Weighed> variances = comparable(all, area, kCalmDeviate);
    if (variances.empty()) continue;
    const double variance = quantile(variances, kCalmPlaces);
    if (!(variance > start.least * start.least)) continue;
    const std::vector<double> rounding = rounding_at(sample(steps_there, some.size()), all);
    if (calm.m.empty()) calm.steps = variance_of_steps(rounding, all);
    enter(all, rounding, kSameNoise * kSameNoise * variance, calm);
    calm.m.push_back(double(m));
    calm.seen.push_back(variance);
  }
  return calm;
}

/// Whether the balls of the i-th m hold a slab as thick as its points scatter.
bool hold_slab(const Calm& calm, std::size_t i) {
  return std::sqrt(calm.seen[i]) < kFlatSlab * calm.radius[i];
}

/// What is left of a variance at m without the part that grows so with m, by that at 2 m.
double without_shape(double at_m, double at_2m, double growth) {
  return (growth * at_m - at_2m) / (growth - 1);
}

/// k of what is seen up to the at-th m if that is so much of sigma^2, `sill`.
double points_of(const Calm& calm, std::size_t at, double sill) {
  std::vector<double> left;
  for (std::size_t i = 0; i <= at; ++i) left.push_back(std::min(1.0, calm.seen[i] / sill));
  return points_sharing(calm.m, left);
}

/// Brings sigma and k to all of the noise, if the points of a disk share it. \param sill what the at-th m,
/// and twice as many, see of sigma^2
void agree(const Calm& calm, std::size_t at, double sill, SharedNoise& found) {
  const double m = calm.m[at];
  const auto all = [&](double k) {
    return sill / without_shape(left_by_quadric(k, m), left_by_quadric(k, 2 * m), kGrowthOfSmoothShape);
  };
  // The more share it, the less of it is seen, and the less is seen, the more share it.
  found.points = greatest_below(points_by_growth(m, calm.seen[at + 1] / calm.seen[at]),
                                [&](double k) { return points_of(calm, at, all(k)) > k; });
  found.sigma = std::sqrt(all(found.points));
}

/// How the variance grows from each m that is looked at to 2 m, one after the other.
class Growths {
 public:
  explicit Growths(bool terraces) : terraces_(terraces) {}

  /// Returns whether other shape overtakes what counted until then. \param own the variance that points have
  /// of their own, about
  bool enter(double at_m, double at_2m, double own) {
    const double growth = at_2m / at_m;
    slow_ = growth > kLeastGrowthOfShape ? 0 : slow_ + 1;
    if (own < kMostlyOwn * at_m) enter_ground((at_2m - own) / (at_m - own));
    const bool overtakes = slow_ == 0 && counts_;
    overtaken_ = overtaken_ || overtakes;
    fast_ = fast_ || slow_ == 0;
    // After it grew as shape does, one slow growth may be the end of a bump, and ground never stops growing.
    const bool stops = !fast_ || (slow_ >= kInARow && (counts_ || growth < kLeastGrowthOfGround));
    counts_ = terraces_ ? counts_ || slow_ > 0 : slow_ > 0 && stops;
    return overtakes;
  }

  /// Whether the last m counts.
  bool counts() const { return counts_; }
  /// Whether they are those of ground, which does not stop growing and is not overtaken.
  bool of_ground() const { return !terraces_ && hills_ >= kInARow && !stopped_ && !overtaken_; }

 private:
  void enter_ground(double growth) {
    stopped_ = stopped_ || growth < (hills_ == 0 ? kMostGrowthOfNoise : kLeastGrowthOfGround);
    ++hills_;
  }

  bool terraces_, counts_ = false, fast_ = false, stopped_ = false, overtaken_ = false;
  std::size_t slow_ = 0;   ///< growths in a row that noise may have
  std::size_t hills_ = 0;  ///< growths that ground was looked for in
};

}  // namespace

SharedNoise find_shared_noise(Places& places, const NoiseStart& start, const DepthSteps* steps,
                              const Context& context) {
  SharedNoise found;
  const Calm calm = look(places, start, steps, context);
  if (calm.m.empty()) return found;                    // nothing scatters, or too few points to tell
  const double of_points = start.sigma * start.sigma;  // what they err by on their own
  // A neighbourhood within one terrace sees nothing of the steps, so the noise may grow steeply. Where what
  // points err by on their own reaches from one step to the next, it does not: ground in whole metres grows
  // as it would without.
  const bool terraces = steps != nullptr && are_two_depths(of_points, rounding_noise(steps->typical()));
  // What a window from below saw much less of at the same m is the distance of two sheets.
  if (!terraces && kLouder * kLouder * of_points < calm.seen.front()) return found;
  double sill = 0, surely = 0;
  std::size_t at = 0;
  const auto make_sure = [&](std::size_t i, double sure) {
    if (sure <= sill) return;
    sill = sure;
    at = i;
  };
  Growths growths(terraces);
  bool held = false;
  for (std::size_t i = 0; i < calm.m.size(); ++i) {
    if (!terraces && !hold_slab(calm, i)) {
      if (held) break;
      continue;  // the narrowest may be inside of the slab
    }
    held = true;
    make_sure(i, std::min(calm.steps, calm.seen[i]));
    if (i + 1 == calm.m.size() || calm.m[i + 1] != 2 * calm.m[i] || calm.m[i] < 2 * double(start.m)) continue;
    if (growths.enter(calm.seen[i], calm.seen[i + 1], of_points) && (terraces || surely > 0)) break;
    if (!growths.counts()) continue;
    const SignsOfSharing &here = calm.signs[i], &next = calm.signs[i + 1];
    // Within terraces no noise is normally distributed.
    const double own = terraces ? 0 : of_points / calm.seen[i + 1];
    if (next.of_two_sheets(own) && calm.two_depths[i + 1] == 0) continue;
    if (!terraces && (next.of_relief() || !next.err_together(calm.m[i + 1]))) continue;
    if (terraces || here.err_together(calm.m[i]))
      surely = std::max(surely, without_shape(calm.seen[i], calm.seen[i + 1], kLeastGrowthOfShape));
    make_sure(i, without_shape(calm.seen[i], calm.seen[i + 1], kGrowthOfSmoothShape));
  }
  if (growths.of_ground()) return found;
  // Compared as variances, for both are lower bounds: with the square of kSameNoise, noise that points share
  // beside their own is missed on a cube.
  if (!(std::max(surely, calm.steps) > kSameNoise * of_points)) return found;
  found = {std::sqrt(sill), points_of(calm, at, sill), std::size_t(calm.m[at])};
  // A terrace is no disk: what neighbourhoods leave of it is not known, unless points' own noise blurs it.
  if (sill > calm.steps && (!terraces || of_points > calm.steps)) agree(calm, at, sill, found);
  return found;
}

}  // namespace rfsmooth::rfs_mesh
