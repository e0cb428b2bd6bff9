#include "rfs_mesh/noise/shared_noise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/sample.h"
#include "rfs_mesh/sheets/two_sheets.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the laws of tests/bench/quality (six shapes, 10,000 points) and on the raw scans of
// tests/bench/scans.
constexpr std::size_t kPointsLooked = 500000;  // at each m: of wide places fewer say as much
// Of the variance, from m to 2 m: second sheets and detail grow faster than noise, shape at least so.
constexpr double kMostGrowthOfNoise = 1.8, kLeastGrowthOfShape = 2.38;
constexpr double kGrowthAcrossEdges = 2;  // 2^p of shape
constexpr std::size_t kSlowInARow = 2;    // the least that is a row
// The same of ground, whose roughness has no scale of its own: 2^H, H from 0.5 on (Mandelbrot 1982).
constexpr double kLeastGrowthOfGround = 1.414;
constexpr double kLeanOfRelief = 0.05;  // a skewness of 0.22
constexpr double kTogether = 0.4;       // above that of points on their own: two standard deviations
// Patches of m points follow noise of their own so that m / (m + kFollows) of 1 is left of `together`: 0.43,
// 0.58, 0.75, 0.82, 0.91 for 32, 64, ... 512 on a plane.
constexpr double kFollows = 45;
constexpr std::size_t kDiskPoints = 300;  // of the disk on which g is computed

/// Share of the area that two disks of radius r have in common at a distance d.
double overlap(double d, double r) {
  if (d >= 2 * r) return 0;
  const double x = d / (2 * r);
  return 2 / M_PI * (std::acos(x) - x * std::sqrt(1 - x * x));
}

/// What a quadric takes of noise shared over a share of the points, q(share) = tr(A^-1 F^T W S W F) / tr W:
/// for shares of 2^-kShares to 1 in powers of two.
constexpr std::size_t kShares = 5;
std::array<double, kShares + 1> taken_shares() {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  std::array<Eigen::Vector2d, kDiskPoints> at;
  std::array<Vector6, kDiskPoints> f;
  Matrix6 a = Matrix6::Zero();
  double weights = 0;
  for (std::size_t i = 0; i < kDiskPoints; ++i) {  // Vogel's spiral: evenly
    const double r = std::sqrt((double(i) + 0.5) / double(kDiskPoints)), turn = M_PI * (3 - std::sqrt(5.0));
    at[i] = r * Eigen::Vector2d(std::cos(double(i) * turn), std::sin(double(i) * turn));
    const double u = at[i].x(), v = at[i].y(), t = r / 1.1, w = (1 - t * t) * (1 - t * t);
    f[i] << 1, u, v, u * u, u * v, v * v;
    a += w * f[i] * f[i].transpose();
    weights += w;
    f[i] *= w;
  }
  std::array<double, kShares + 1> taken = {};
  for (std::size_t s = 0; s <= kShares; ++s) {
    const double radius = std::sqrt(std::pow(0.5, double(kShares - s)));
    Matrix6 shared = Matrix6::Zero();
    for (std::size_t i = 0; i < kDiskPoints; ++i) {
      Vector6 sum = Vector6::Zero();
      for (std::size_t j = 0; j < kDiskPoints; ++j) sum += overlap((at[i] - at[j]).norm(), radius) * f[j];
      shared += f[i] * sum.transpose();
    }
    taken[s] = a.ldlt().solve(shared).trace() / weights;
  }
  return taken;
}

/// g(k / m).
double left_by_quadric(double points, double m) {
  static const std::array<double, kShares + 1> taken = taken_shares();
  const double least = std::pow(0.5, double(kShares)), own = std::min(0.9, taken[0] / least / m);
  if (points <= 1) return 1;
  const double share = points / m;
  double q = 0;
  if (share <= least) {
    q = taken[0] * share / least;
  } else {
    const double place = std::min(double(kShares), std::log2(share) + double(kShares));
    const auto below = std::min(kShares - 1, std::size_t(place));
    q = taken[below] + (place - double(below)) * (taken[below + 1] - taken[below]);
    if (share > 1) q = 1 - (1 - q) / (share * share);  // a quadric follows all but what is left of the edge
  }
  return std::max(1e-3, (1 - q) / (1 - own));
}

/// k by the neighbourhood that sees half of the noise's variance, or by the narrowest if that sees more:
/// what follows such noise is what k is asked for. `left`: what a quadric leaves of the noise, over its
/// variance, at each m, ascending to 1.
double points_sharing(const std::vector<double>& m, const std::vector<double>& left) {
  constexpr double kHalf = 0.5;
  double at = m.front(), seen = left.front();
  for (std::size_t i = 0; i + 1 < left.size() && left[i] < kHalf; ++i) {
    const double part = std::min(1.0, (kHalf - left[i]) / std::max(1e-9, left[i + 1] - left[i]));
    at = m[i] * std::pow(m[i + 1] / m[i], part);
    seen = std::min(kHalf, left[i + 1]);
  }
  double fewest = 1, most = m.back();
  for (int round = 0; round < 40; ++round) {
    const double middle = std::sqrt(fewest * most);
    (left_by_quadric(middle, at) > seen ? fewest : most) = middle;
  }
  return fewest;
}

/// What calm places show, by the number of neighbours, ascending.
struct Calm {
  std::vector<double> m, seen;  ///< points, variance about a quadric
  /// Means of that of Scatter: 1, less what patches follow of it, of noise that points have of their own, up
  /// to kRing where they share it.
  std::vector<double> together;
  /// Medians, since that of a few rocks on a sea floor is large.
  std::vector<double> flatness, lean;
  std::vector<double> radius;  ///< mean, of their balls
  double steps = 0;            ///< variance that depths in steps make sure of
};

/// Enters what the fits of at most this variance show of how points err.
void enter(const std::vector<Scatter>& all, double variance, Calm& calm) {
  double together = 0, radius = 0, count = 0;
  std::vector<double> flatness, lean;
  for (const Scatter& s : all) {
    if (!says(s) || s.variance > variance) continue;
    together += s.together;
    flatness.push_back(s.flatness);
    lean.push_back(s.lean_in_common);
    radius += s.radius;
    ++count;
  }
  calm.together.push_back(count > 0 ? together / count : 0);
  calm.flatness.push_back(median(flatness));
  calm.lean.push_back(median(lean));
  calm.radius.push_back(count > 0 ? radius / count : 0);
}

Calm look(Places& places, const NoiseStart& start, const DepthSteps* steps, const Context& context) {
  Calm calm;
  const SpatialIndex& index = places.index();
  // Half of what fits take at most: else parts of the cloud are shape.
  const std::size_t last = std::min(widest_scatter(index), index.points().size() / (2 * kShareOfCloud));
  for (std::size_t m = std::max(start.m, start.narrowest); m <= last; m *= 2) {
    Places fewer(index, sample(places.at(), kPointsLooked / m), 0, context);
    Places& some = fewer.size() < places.size() ? fewer : places;
    const std::vector<Scatter> all = some.fits(m);
    const std::vector<double> area = areas(all);
    std::vector<Weighed> variances = comparable(all, area, kCalmDeviate);
    if (variances.empty()) continue;
    const double variance = quantile(variances, kCalmPlaces);
    if (!(variance > start.least * start.least)) continue;
    if (calm.m.empty() && steps != nullptr) calm.steps = variance_of_steps(*steps, some, all);
    enter(all, kSameNoise * kSameNoise * variance, calm);
    calm.m.push_back(double(m));
    calm.seen.push_back(variance);
  }
  return calm;
}

/// Whether the balls of the i-th m hold a slab as thick as its points scatter.
bool hold_slab(const Calm& calm, std::size_t i) {
  return std::sqrt(calm.seen[i]) < kFlatSlab * calm.radius[i];
}

/// Whether nearest points lie off patches of the i-th m the same way.
bool err_together(const Calm& calm, std::size_t i) {
  return calm.together[i] > calm.m[i] / (calm.m[i] + kFollows) + kTogether;
}

/// How flat the i-th residuals are beyond the noise that points have of their own, of the variance `own`.
/// That is normal and adds nothing to the fourth cumulant, so what is left of the variance has all of it.
/// Half of the variance is taken at least: the flatness of next to nothing is chance.
double flatness_beyond(const Calm& calm, std::size_t i, double own) {
  const double left = std::max(0.5, 1 - own / calm.seen[i]);
  return kNormalFlatness + (calm.flatness[i] - kNormalFlatness) / (left * left);
}

/// What is left of the i-th variance without the part that grows with m as shape does.
double without_shape(const Calm& calm, std::size_t i, double growth) {
  return (growth * calm.seen[i] - calm.seen[i + 1]) / (growth - 1);
}

}  // namespace

SharedNoise find_shared_noise(Places& places, const NoiseStart& start, const DepthSteps* steps,
                              const Context& context) {
  SharedNoise found;
  const Calm calm = look(places, start, steps, context);
  if (calm.m.empty()) return found;  // nothing scatters, or too few points to tell
  // A neighbourhood within one terrace sees nothing of the steps, so the noise may grow steeply. The shells
  // of a laser scanner are finer than its noise.
  const bool terraces = steps != nullptr && !steps->on_shells();
  // What a window from below saw much less of at the same m is the distance of two sheets.
  if (!terraces && kLouder * kLouder * start.sigma * start.sigma < calm.seen.front()) return found;
  double sill = 0, surely = 0;
  std::size_t at = 0;
  const auto make_sure = [&](std::size_t i, double sure) {
    if (sure <= sill) return;
    sill = sure;
    at = i;
  };
  bool held = false, wide = false, fast = false;
  std::size_t slow = 0;  // growths in a row that noise may have
  for (std::size_t i = 0; i < calm.m.size(); ++i) {
    if (!terraces && !hold_slab(calm, i)) {
      if (held) break;
      continue;  // the narrowest may be inside of the slab
    }
    held = true;
    make_sure(i, std::min(calm.steps, calm.seen[i]));
    if (i + 1 == calm.m.size() || calm.m[i + 1] != 2 * calm.m[i] || calm.m[i] < 2 * double(start.m)) continue;
    const double growth = calm.seen[i + 1] / calm.seen[i];
    slow = growth > (terraces ? kGrowthAcrossEdges : kMostGrowthOfNoise) ? 0 : slow + 1;
    if (slow == 0 && wide && (terraces || surely > 0)) break;
    fast = fast || slow == 0;
    // After it grew as shape does, one slow growth may be the end of a bump, and ground never stops growing.
    const bool stops = !fast || (slow >= kSlowInARow && (wide || growth < kLeastGrowthOfGround));
    wide = terraces ? wide || slow > 0 : slow > 0 && stops;
    if (!wide) continue;
    // Within terraces no noise is normal.
    const double flatness =
        terraces ? calm.flatness[i + 1] : flatness_beyond(calm, i + 1, start.sigma * start.sigma);
    if (flatness < kFlatnessOfSheets) continue;
    if (!terraces && calm.lean[i + 1] > kLeanOfRelief) continue;
    if (!terraces && !err_together(calm, i + 1)) continue;
    if (terraces || err_together(calm, i))
      surely = std::max(surely, without_shape(calm, i, kLeastGrowthOfShape));
    make_sure(i, without_shape(calm, i, kGrowthOfSmoothShape));
  }
  if (!(std::max(surely, calm.steps) > kSameNoise * start.sigma * start.sigma)) return found;
  found.sigma = std::sqrt(sill);
  found.m = std::size_t(calm.m[at]);
  std::vector<double> left;
  for (std::size_t i = 0; i <= at; ++i) left.push_back(std::min(1.0, calm.seen[i] / sill));
  found.points = points_sharing(calm.m, left);
  return found;
}

}  // namespace rfsmooth::rfs_mesh
