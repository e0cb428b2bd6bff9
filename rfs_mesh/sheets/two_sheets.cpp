#include "rfs_mesh/sheets/two_sheets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "base/linear/small_cholesky.h"
#include "rfs_mesh/fit/quadric_moments.h"
#include "rfs_mesh/levels.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

constexpr int kPairRounds = 12;        // of expectation maximisation: a bound of the work
constexpr double kRidgeOfPair = 1e-6;  // of the normal equations, beside the weights
constexpr double kLeastWeights = 30;   // nine unknowns, and
constexpr double kUnknowns = 9;        // of the two sheets
// Chosen on rotor, armadillo, anchor_dense and plate at 10,000 and 50,000 points, noise of 1 to 3 %, and so
// that the depths of real sensors, which come in steps, say nothing: patches on rotor's walls at 1 % have
// nats of 3 to 40, known of 0.65 to 1, and 1.3 to 2 between a sheet and the middle; those that did harm
// elsewhere 2.2 to 3; sensors' steps known of 0.45 to 0.85.
constexpr double kMostLeftByPair = 1.5;  // mean square, of points and of cells' means, over that of noise
constexpr double kKnown = 0.6;
constexpr double kFarApart = 2.1;     // one point in 56 crosses the middle: patches of one sheet do as well
constexpr int kCells = 5;             // a side of the grid
constexpr double kLeastInCell = 0.3;  // sum of squared weights
// By so much all points may be below what some of them show: four deviations of the variance of a hundred.
constexpr double kByChance = 1.6;

constexpr double kMostCertain = 50;        // logarithm of the odds of a label
constexpr double kRidgeOfLabelled = 1e-9;  // as kRidgeOfPair, of labels given
constexpr double kSharper = 4;             // than the expected label, where
constexpr double kSharpFrom = 0.5;         // d^2 / c is above this

/// E[s | e] of a point whose P is known.
double label(const SheetPoint& p) {
  return 2 * p.upper - 1;
}

/// P in noise of variance 1.
double probability(double above, double apart) {
  return 1 / (1 + std::exp(std::clamp(-2 * above * apart, -kMostCertain, kMostCertain)));
}

/// Of both sheets, without the constant of the normal distribution.
double log_likelihood_of_two(double above, double apart, double variance) {
  return std::log(0.5 * std::exp(-0.5 * std::pow(above - apart, 2) / variance) +
                  0.5 * std::exp(-0.5 * std::pow(above + apart, 2) / variance) + 1e-300) -
         0.5 * std::log(variance);
}

/// The points by column, as the rounds of a fit read them.
struct PairColumns {
  Eigen::ArrayXd u, v, height, weight, labels;
  Eigen::Matrix<double, Eigen::Dynamic, 10>
      moments;                                       ///< weight times 1, u, v, u^2, u v, v^2, u^3, u^2 v, ...
  Eigen::Matrix<double, Eigen::Dynamic, 3> heights;  ///< weight times height times 1, u, v

  explicit PairColumns(const std::vector<SheetPoint>& points) {
    const auto n = Eigen::Index(points.size());
    for (Eigen::ArrayXd* column : {&u, &v, &height, &weight, &labels}) column->resize(n);
    moments.resize(n, 10);
    heights.resize(n, 3);
    for (Eigen::Index k = 0; k < n; ++k) {
      const SheetPoint& p = points[std::size_t(k)];
      u[k] = p.u;
      v[k] = p.v;
      height[k] = p.height;
      weight[k] = p.weight;
      labels[k] = label(p);
      const double uu = p.u * p.u, vv = p.v * p.v;
      const double of[10] = {1, p.u, p.v, uu, p.u * p.v, vv, uu * p.u, uu * p.v, p.u * vv, p.v * vv};
      for (int m = 0; m < 10; ++m) moments(k, m) = p.weight * of[m];
      for (int m = 0; m < 3; ++m) heights(k, m) = p.weight * p.height * of[m];
    }
  }
};

}  // namespace

SheetPair::SheetPair(std::vector<SheetPoint>& points) {
  for (const SheetPoint& p : points) weights_ += p.weight;
  if (weights_ < kLeastWeights) return;
  fit_one(points);
  possible_ = kByChance * single_ > 1;
  if (!(single_ > 1)) return;  // no more than noise: nothing to part
  fit_two(points);
  if (middle_.allFinite() && apart_.allFinite()) judge(points);
}

double SheetPair::middle(const SheetPoint& p) const {
  const Vector6& c = middle_;
  return (c[0] + (p.v * c[2] + p.u * p.v * c[4])) + (p.u * c[1] + (p.u * p.u * c[3] + p.v * p.v * c[5]));
}

double SheetPair::apart(const SheetPoint& p) const {
  return apart_[0] + apart_[1] * p.u + apart_[2] * p.v;
}

double SheetPair::nearer(const SheetPoint& p) const {
  const double m = middle(p);
  return m + nearer_label(p.height - m) * apart(p);
}

void SheetPair::fit_one(std::vector<SheetPoint>& points) {
  QuadricMoments<double> moments;
  QuadricHeights<double> heights;
  for (const SheetPoint& p : points) {
    moments.add(p.u, p.v, p.weight);
    heights.add(p.u, p.v, p.weight * p.height);
  }
  const auto itself = [](double sum) { return sum; };
  moments_ = moments.matrix(itself);
  moments_.diagonal().array() += kRidgeOfPair * weights_;
  heights_ = heights.vector(itself);
  middle_ = SmallCholesky<6>(moments_).solve(heights_);
  for (const SheetPoint& p : points) single_ += p.weight * std::pow(p.height - middle(p), 2);
  single_ /= weights_;
  const double d = std::sqrt(std::max(0.0, squared_apart(single_, 1)));
  for (SheetPoint& p : points) p.upper = probability(p.height - middle(p), d);
}

void SheetPair::fit_two(std::vector<SheetPoint>& points) {
  // The normal equations of f, s (1, u, v) hold products of the labels with moments of degree 3 and less.
  constexpr std::array<std::array<int, 3>, 6> kProduct = {
      {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}, {3, 6, 7}, {4, 7, 8}, {5, 8, 9}}};
  const PairColumns of(points);
  Eigen::ArrayXd labels = of.labels;
  for (int round = 0; round < kPairRounds; ++round) {
    const Eigen::Matrix<double, 10, 1> once = of.moments.transpose() * labels.matrix();
    const Vector6 twice = of.moments.leftCols<6>().transpose() * labels.square().matrix();
    Matrix9 a = Matrix9::Zero();  // its lower half
    Vector9 right;
    right << heights_, of.heights.transpose() * labels.matrix();
    a.topLeftCorner<6, 6>() = moments_;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 3; ++j) a(6 + j, i) = once[kProduct[i][j]];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) a(6 + i, 6 + j) = twice[kProduct[i][j]];
    a.bottomRightCorner<3, 3>().diagonal().array() += kRidgeOfPair * weights_;
    const Vector9 x = SmallCholesky<9>(a).solve(right);
    const double up = x[6] < 0 ? -1 : 1;  // the upper one is the one above
    middle_ = x.head<6>();
    apart_ = up * x.tail<3>();
    const Eigen::ArrayXd above = of.height - middle_[0] - of.u * (middle_[1] + middle_[3] * of.u) -
                                 of.v * (middle_[2] + middle_[4] * of.u + middle_[5] * of.v),
                         d = apart_[0] + apart_[1] * of.u + apart_[2] * of.v;
    labels = 2 / (1 + (-2 / variance_ * above * d).max(-kMostCertain).min(kMostCertain).exp()) - 1;
    // P (above - d)^2 + (1 - P) (above + d)^2
    const double squares = (of.weight * (above.square() + d.square() - 2 * labels * above * d)).sum();
    left_ = squares / (weights_ - kUnknowns);
    variance_ = std::clamp(left_, kLeastPart, 1.0);
  }
  for (std::size_t k = 0; k < points.size(); ++k) points[k].upper = (1 + labels[Eigen::Index(k)]) / 2;
}

void SheetPair::judge(const std::vector<SheetPoint>& points) {
  struct Cell {
    double middle = 0, apart = 0, squares = 0;  // residuals times weights, squared weights
  };
  std::array<std::array<Cell, kCells>, kCells> cells;
  const auto cell_of = [](double u) {
    return std::size_t(std::clamp((u + 1) * kCells / 2, 0.0, kCells - 1.0));
  };
  double two = 0, known = 0, all = 0;
  for (const SheetPoint& p : points) {
    if (p.weight == 0) continue;
    const double above = p.height - middle(p), d = apart(p);
    const double s = label(p);
    two += p.weight * log_likelihood_of_two(above, d, variance_);
    known += p.weight * (p.estimate - middle(p)) * s;
    all += p.weight * d * s * s;
    Cell& cell = cells[cell_of(p.u)][cell_of(p.v)];
    cell.middle += p.weight * (above - s * d);
    cell.apart += p.weight * (s * above - d);
    cell.squares += p.weight * p.weight;
  }
  const double one = -0.5 * weights_ * (std::log(single_) + 1);
  double misfit = 0;
  int counted = 0;
  for (const auto& row : cells)
    for (const Cell& cell : row) {
      if (cell.squares < kLeastInCell) continue;
      misfit += (cell.middle * cell.middle + cell.apart * cell.apart) / (cell.squares * variance_);
      counted += 2;
    }
  possible_ = left_ < kByChance * kMostLeftByPair && misfit < kByChance * kMostLeftByPair * counted;
  convincing_ = two - one > kNatsOfTwo && left_ < kMostLeftByPair && misfit < kMostLeftByPair * counted &&
                apart_[0] < kFarApart && known > kKnown * all;
}

void LabelledSheets::add(const Eigen::Vector2d& uv, double height, double label, double weight) {
  const Eigen::Vector4d f(1, uv.x(), uv.y(), label);
  a_.noalias() += weight * f * f.transpose();
  right_ += weight * height * f;
  squares_ += weight * height * height;
  weights_ += weight;
}

LabelledSheets::Fit LabelledSheets::fit() const {
  Eigen::Matrix4d a = a_;
  a.diagonal().array() += kRidgeOfLabelled * weights_;
  const Eigen::Vector4d x = a.ldlt().solve(right_);
  return {x[0], {x[1], x[2]}, x[3], (squares_ - x.dot(right_)) / weights_};
}

SplitHeights split_heights(const std::vector<double>& ascending, std::size_t fewest) {
  const std::size_t n = ascending.size();
  double sum = 0, squares = 0, below = 0, least = std::numeric_limits<double>::infinity();
  for (const double height : ascending) {
    sum += height;
    squares += height * height;
  }
  SplitHeights split = {fewest, 0};
  for (std::size_t k = 1; k + fewest <= n; ++k) {
    below += ascending[k - 1];
    if (k < fewest) continue;
    const double within = squares - below * below / double(k) - (sum - below) * (sum - below) / double(n - k);
    if (within < least) {
      least = within;
      split.lower = k;
    }
  }
  split.variance = std::max(0.0, least) / double(n);
  return split;
}

double share_of_sheet(double flatness, double lean) {
  if (!(lean > 0)) return 1 - std::sqrt(std::clamp((3 - flatness) / 2, 0.0, 1.0));
  double low = 0, high = 1;  // there is one positive root
  for (double a = 0.5; low < a && a < high; a = (low + high) / 2)
    (2 * a * a * a - (3 - flatness) * a < lean ? low : high) = a;
  return 1 - high;
}

double squared_gap(double of_sheet, double lean) {
  const double a = 1 - of_sheet;
  return 4 * a + lean / (a * a);
}

double sharpened_label(double above, double apart, double variance) {
  const double sharper = apart * apart > kSharpFrom * variance ? kSharper : 1;
  return expected_label(above, sharper * apart, variance);
}

}  // namespace rfsmooth::rfs_mesh
