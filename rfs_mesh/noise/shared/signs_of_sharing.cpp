#include "rfs_mesh/noise/shared/signs_of_sharing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/sheets/two_sheets.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the laws of tests/bench/quality (six shapes, 10,000 points) and on the raw scans of
// tests/bench/scans.
constexpr double kLeanOfRelief = 0.05;  // a skewness of 0.22
constexpr double kTogether = 0.4;       // above that of points on their own: two standard deviations
// Patches of m points follow noise of their own so that m / (m + kFollows) of 1 is left of `together`: 0.43,
// 0.58, 0.75, 0.82, 0.91 for 32, 64, ... 512 on a plane. Of `in_rows` they leave about as much: 0.3, 0.6,
// 0.8.
constexpr double kFollows = 45;
constexpr double kFastest = 0.25;         // k / m at which g(k / 2 m) / g(k / m) is greatest
constexpr std::size_t kDiskPoints = 300;  // of the disk on which g is computed

/// How flat residuals are beyond the noise that points have of their own, `own` of the variance. That is
/// normal and adds nothing to the fourth cumulant, so what is left of the variance has all of it. Half of the
/// variance is taken at least: the flatness of next to nothing is chance. \param flatness Scatter::flatness
double flatness_beyond(double flatness, double own) {
  const double left = std::max(0.5, 1 - own);
  return kNormalFlatness + (flatness - kNormalFlatness) / (left * left);
}

/// Share of the area that two disks of radius r have in common at a distance d.
double overlap(double d, double r) {
  if (d >= 2 * r) return 0;
  const double x = d / (2 * r);
  return 2 / M_PI * (std::acos(x) - x * std::sqrt(1 - x * x));
}

/// What a least squares fit of a quadric takes of noise shared over a share of the points of a disk, of its
/// variance,
///
///     q(share) = tr(A^-1 F^T W S W F) / tr W,   A = F^T W F
///
/// for shares of 2^-kShares to 1 in powers of two. F are the terms of the quadric at the points, W their
/// weights (scatter.h), S the correlations of their noise: the noise of a point is the mean of what lies in a
/// disk of that share around it, so two are as alike as their disks overlap.
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
    const double u = at[i].x(), v = at[i].y(), t = r / kBeyond, w = (1 - t * t) * (1 - t * t);
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

}  // namespace

double left_by_quadric(double points, double m) {
  static const std::array<double, kShares + 1> taken = taken_shares();
  // Small shares are taken in proportion. `own`: of noise that each point has of its own, the share 1 / m.
  const double least = std::pow(0.5, double(kShares)), own = std::min(0.9, taken[0] / least / m);
  if (points <= 1) return 1;  // what is left of noise of their own is the unit
  const double share = points / m;
  double q = 0;
  if (share <= least) {
    q = taken[0] * share / least;
  } else {
    const double place = std::min(double(kShares), std::log2(share) + double(kShares));
    const auto below = std::min(kShares - 1, std::size_t(place));
    q = taken[below] + (place - double(below)) * (taken[below + 1] - taken[below]);
    // Noise that reaches beyond the disk looks ever more like a quadric in it.
    if (share > 1) q = 1 - (1 - q) / (share * share);
  }
  return std::max(1e-3, (1 - q) / (1 - own));
}

bool SignsOfSharing::err_together(double m) const {
  return together > m / (m + kFollows) + kTogether || err_in_rows(m);
}

bool SignsOfSharing::err_in_rows(double m) const {
  return in_rows > m / (m + kFollows) + kTogether;
}

bool SignsOfSharing::err_row_by_row(double m) const {
  return in_rows > kLouder * (m / (m + kFollows) + kTogether) && next_row < kLittle * in_row;
}

bool SignsOfSharing::of_two_sheets(double own) const {
  return flatness_beyond(flatness, own) < kFlatnessOfSheets;
}

bool SignsOfSharing::of_relief() const {
  return lean > kLeanOfRelief;
}

SignsOfSharing signs_of(const std::vector<const Scatter*>& fits) {
  SignsOfSharing signs;
  if (fits.empty()) return signs;
  std::vector<double> flatness, lean;
  for (const Scatter* const fit : fits) {
    signs.together += fit->together;
    signs.in_rows += fit->in_rows;
    signs.in_row += fit->in_row;
    signs.next_row += fit->next_row;
    flatness.push_back(fit->flatness);
    lean.push_back(fit->lean_in_common);
  }
  for (double* const sum : {&signs.together, &signs.in_rows, &signs.in_row, &signs.next_row})
    *sum /= double(fits.size());
  signs.flatness = median(flatness);
  signs.lean = median(lean);
  return signs;
}

double points_sharing(const std::vector<double>& m, const std::vector<double>& left) {
  constexpr double kHalf = 0.5;
  const auto points_of = [&](double at, double seen) {
    return greatest_below(m.back(), [&](double k) { return left_by_quadric(k, at) > seen; });
  };
  std::size_t i = 0;
  while (i + 1 < left.size() && left[i] < kHalf) ++i;
  double points = 0;
  if (i > 0) {  // the m that sees half is between two
    const double part = std::min(1.0, (kHalf - left[i - 1]) / std::max(1e-9, left[i] - left[i - 1]));
    points = points_of(m[i - 1] * std::pow(m[i] / m[i - 1], part), std::min(kHalf, left[i]));
  }
  for (; i < left.size(); ++i)
    if (points == 0 || left[i] > kHalf) points = std::max(points, points_of(m[i], left[i]));
  return points;
}

double points_by_growth(double m, double growth) {
  return greatest_below(kFastest * m,
                        [&](double k) { return left_by_quadric(k, 2 * m) < growth * left_by_quadric(k, m); });
}

}  // namespace rfsmooth::rfs_mesh
