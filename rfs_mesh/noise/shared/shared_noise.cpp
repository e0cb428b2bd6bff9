#include "rfs_mesh/noise/shared/shared_noise.h"

#include <algorithm>
#include <cmath>

#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/shared/growths.h"
#include "rfs_mesh/noise/shared/signs_of_sharing.h"
#include "rfs_mesh/noise/steps/terraces.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the laws of tests/bench/quality (six shapes, 10,000 points) and on the raw scans of
// tests/bench/scans.
constexpr std::size_t kPointsLooked = 500000;  // at each m: of wide places fewer say as much

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

Calm look_at_calm(Places& places, const NoiseStart& start, const DepthSteps* steps, const Context& context) {
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

/// What is left of a variance at m without the part that grows so with m, by that at 2 m.
double without_shape(double at_m, double at_2m, double growth) {
  return (growth * at_m - at_2m) / (growth - 1);
}

/// The search through these, from few points to many. By the i-th m: each rule by which one is believed.
class SharedSearch {
 public:
  SharedSearch(const Calm& calm, const NoiseStart& start, const DepthSteps* steps)
      : calm_(calm),
        of_points_(start.sigma * start.sigma),
        of_start_(double(start.m)),
        terraces_(steps != nullptr && are_two_depths(of_points_, rounding_noise(steps->typical()))) {}

  SharedNoise run();

 private:
  /// Whether windows from below saw much less at the narrowest m: what is seen without them is the distance
  /// of two sheets.
  bool is_of_sheets() const { return kLouder * kLouder * of_points_ < calm_.seen.front(); }

  /// Whether the balls hold a slab as thick as their points scatter. The narrowest may be inside of it; where
  /// wider ones do not hold it any more, they are full of leaves and twigs.
  bool holds_slab(std::size_t i) const {
    return terraces_ || std::sqrt(calm_.seen[i]) < kFlatSlab * calm_.radius[i];
  }

  /// Whether m is above the one that the search for points' own noise took, and the next is twice that.
  bool has_growth(std::size_t i) const {
    return i + 1 < calm_.m.size() && calm_.m[i + 1] == 2 * calm_.m[i] && calm_.m[i] >= 2 * of_start_;
  }

  /// Whether residuals, beyond the noise that points have of their own, are those of two sheets or of waves
  /// in rows: a sine has a flatness of 1.5, threads and ripples measured under noise 1.6 to 2.1, noise that
  /// points share 2.9 and more. Not those at two depths that follow each other, between which noise carries
  /// the points of one wall. Within terraces no noise is normally distributed.
  bool is_flat(std::size_t i) const {
    const double own = terraces_ ? 0 : of_points_ / calm_.seen[i];
    return calm_.signs[i].of_two_sheets(own) && calm_.two_depths[i] == 0;
  }

  /// Whether nearest points are off the same way. Loud points among calm ones make the scatter grow, too, but
  /// each is off by itself. On terraces they are, by the step that they are on.
  bool errs_together(std::size_t i) const { return terraces_ || calm_.signs[i].err_together(calm_.m[i]); }

  /// Whether residuals lean: noise is as often above as below, stones are round above and end in clefts. Not
  /// asked on terraces.
  bool is_relief(std::size_t i) const { return !terraces_ && calm_.signs[i].of_relief(); }

  /// Whether 2 m, which are not flat, show noise that neighbours share.
  bool is_shared(std::size_t i) const { return !is_relief(i + 1) && errs_together(i + 1); }

  /// What is left of the variance at m without shape that grows so to 2 m.
  double without(double growth, std::size_t i) const {
    return without_shape(calm_.seen[i], calm_.seen[i + 1], growth);
  }

  void make_sure(std::size_t i, double variance);
  void look();
  double points_of(double sill) const;
  void agree(SharedNoise& found) const;

  const Calm& calm_;
  double of_points_;     ///< variance of what points err by on their own
  double of_start_;      ///< the m of the search for it
  bool terraces_;        ///< where that reaches from one step to the next, ground grows as without steps
  double sill_ = 0;      ///< the most that is sure of the variance, once there is such noise
  std::size_t at_ = 0;   ///< which m tells that
  double surely_ = 0;    ///< the most that is noise even if shape grows as slowly as it may
  double of_waves_ = 0;  ///< what the widest see that are flat: wider ones see the same waves and some shape
  bool ground_ = false;
};

void SharedSearch::make_sure(std::size_t i, double variance) {
  if (variance <= sill_) return;
  sill_ = variance;
  at_ = i;
}

void SharedSearch::look() {
  Growths growths(terraces_);
  std::size_t i = 0;
  while (i < calm_.m.size() && !holds_slab(i)) ++i;
  for (; i < calm_.m.size() && holds_slab(i); ++i) {
    make_sure(i, std::min(calm_.steps, calm_.seen[i]));
    if (!has_growth(i)) continue;
    const bool overtaken = growths.enter(calm_.seen[i], calm_.seen[i + 1], of_points_);
    if (overtaken && (terraces_ || surely_ > 0)) break;
    if (!growths.counts()) continue;
    if (is_flat(i + 1)) {
      of_waves_ = calm_.seen[i + 1];
      continue;
    }
    if (!is_shared(i)) continue;
    if (errs_together(i)) surely_ = std::max(surely_, without(kLeastGrowthOfShape, i));
    make_sure(i, without(kGrowthOfSmoothShape, i));
  }
  ground_ = growths.of_ground();
}

/// k of what is seen up to the m that tells, if that is so much of sigma^2.
double SharedSearch::points_of(double sill) const {
  std::vector<double> left;
  for (std::size_t i = 0; i <= at_; ++i) left.push_back(std::min(1.0, calm_.seen[i] / sill));
  return points_sharing(calm_.m, left);
}

/// Brings sigma and k to all of the noise, if the points of a disk share it.
void SharedSearch::agree(SharedNoise& found) const {
  const double m = calm_.m[at_];
  const auto all = [&](double k) {
    return sill_ / without_shape(left_by_quadric(k, m), left_by_quadric(k, 2 * m), kGrowthOfSmoothShape);
  };
  // The more share it, the less of it is seen, and the less is seen, the more share it.
  found.points = greatest_below(points_by_growth(m, calm_.seen[at_ + 1] / calm_.seen[at_]),
                                [&](double k) { return points_of(all(k)) > k; });
  found.sigma = std::sqrt(all(found.points));
}

SharedNoise SharedSearch::run() {
  if (!terraces_ && is_of_sheets()) return {};
  look();
  if (ground_) return {};
  // Compared as variances, for both are lower bounds: with the square of kSameNoise, noise that points share
  // beside their own is missed on a cube.
  if (!(std::max(surely_, calm_.steps) > kSameNoise * std::max(of_points_, of_waves_))) return {};
  SharedNoise found{std::sqrt(sill_), points_of(sill_), std::size_t(calm_.m[at_])};
  // A terrace is no disk: what neighbourhoods leave of it is not known, unless points' own noise blurs it.
  if (sill_ > calm_.steps && (!terraces_ || of_points_ > calm_.steps)) agree(found);
  return found;
}

}  // namespace

SharedNoise find_shared_noise(Places& places, const NoiseStart& start, const DepthSteps* steps,
                              const Context& context) {
  const Calm calm = look_at_calm(places, start, steps, context);
  if (calm.m.empty()) return {};  // nothing scatters, or too few points to tell
  return SharedSearch(calm, start, steps).run();
}

}  // namespace rfsmooth::rfs_mesh
