#include "rfs_mesh/noise/shared_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace rfsmooth::rfs_mesh {

namespace {

constexpr std::size_t kMostOfCloud =
    24;  // m is at most so small a part of the cloud: else its parts are shape
constexpr std::size_t kMostGrowth = 64;  // the widest m over the narrowest
constexpr std::size_t kMostPoints = 2048;
constexpr double kCalmPlaces = 0.25, kCalmDeviation = -0.674;
constexpr double kShapePower = 1.5;  // p, at least, of shape
constexpr double kTwoSheets = 4;     // of the variance
constexpr double kMostGrowthOfNoise =
    1.6;  // of the variance, from m to 2 m: second sheets and detail grow faster
constexpr double kSurelyShared = 1.25;    // sigma over that of the start
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

/// k by least absolute deviations (in steps, the narrowest m may lie within one and show nothing): what a
/// quadric leaves of the noise, over its variance, at each m.
double fit_points(const std::vector<double>& m, const std::vector<double>& left) {
  double best = 1, least = std::numeric_limits<double>::infinity();
  for (double points = 1; points <= m.back(); points *= std::sqrt(2.0)) {
    double misfit = 0;
    for (std::size_t i = 0; i < m.size(); ++i)
      misfit += std::abs(std::log(left_by_quadric(points, m[i]) / left[i]));
    if (misfit < least) {
      least = misfit;
      best = points;
    }
  }
  return best;
}

/// Whether a coordinate has few values, as depths of a camera have.
bool in_steps(const Positions& points) {
  constexpr std::size_t kLooked = 20000, kTimes = 10, kFewestSteps = 32;  // fewer are walls
  const Positions some = pick(points, std::min(points.size(), kLooked));
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& p : some) values.push_back(p[axis]);
    std::sort(values.begin(), values.end());
    const auto last = std::unique(values.begin(), values.end());
    const auto steps = std::size_t(last - values.begin());
    if (steps >= kFewestSteps && steps * kTimes < some.size()) return true;
  }
  return false;
}

}  // namespace

SharedNoise find_shared_noise(const SpatialIndex& index, const Positions& places, const NoiseStart& start,
                              const Context& context) {
  const std::size_t n = index.points().size();
  const std::vector<double> open(places.size(), 0);
  std::vector<double> m, seen;
  const std::size_t last = std::min({kMostPoints, n / kMostOfCloud, kMostGrowth * start.m});
  for (std::size_t count = start.m; count <= last; count *= 2) {
    const std::vector<Scatter> all = fits(index, places, count, open, context);
    std::vector<Weighed> variances = comparable(all, areas(all), kCalmDeviation);
    if (variances.empty()) continue;
    const double variance = quantile(variances, kCalmPlaces);
    if (!(variance > start.least * start.least)) continue;
    m.push_back(double(count));
    seen.push_back(variance);
  }
  SharedNoise found;
  found.stepped = in_steps(index.points());
  if (seen.empty()) return found;  // nothing scatters, or too few points to tell
  double sill = 0;
  std::size_t at = 0;
  // What a window from below saw much less of at the same m is the distance of two sheets.
  if (!found.stepped && kTwoSheets * start.sigma * start.sigma < seen.front()) return found;
  for (std::size_t i = 0; i + 1 < m.size(); ++i) {
    if (m[i + 1] != 2 * m[i] || m[i] < 2 * double(start.m)) continue;
    if (!found.stepped && seen[i + 1] > kMostGrowthOfNoise * seen[i]) break;
    const double grows = std::pow(2, kShapePower), sure = (grows * seen[i] - seen[i + 1]) / (grows - 1);
    if (sure <= sill) continue;
    sill = sure;
    at = i;
  }
  if (!(sill > kSurelyShared * kSurelyShared * start.sigma * start.sigma)) return found;
  found.sigma = std::sqrt(sill);
  std::vector<double> left;
  for (std::size_t i = 0; i <= at; ++i) left.push_back(std::min(1.0, seen[i] / sill));
  m.resize(at + 1);
  found.m = std::size_t(m[at]);
  found.points = fit_points(m, left);
  return found;
}

}  // namespace rfsmooth::rfs_mesh
