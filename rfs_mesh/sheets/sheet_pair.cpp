#include "rfs_mesh/sheets/sheet_pair.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/small_cholesky.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

constexpr int kPairRounds = 12;
constexpr double kRidgeOfPair = 1e-6;    // of the normal equations, beside the weights
constexpr double kLeastWeights = 30;     // nine unknowns, and
constexpr double kUnknowns = 13;         // what they take of the variance: the weights are not all one
constexpr double kLeastVariance = 0.35;  // s^2
// Chosen on rotor, armadillo, anchor_dense and plate at 10,000 and 50,000 points, noise of 1 to 3 %, and so
// that the depths of real sensors, which come in steps, say nothing: patches on rotor's walls at 1 % have
// nats of 3 to 40, known of 0.65 to 1, less than 0.12 of place and 1.3 to 2 between a sheet and the middle;
// those that did harm elsewhere 2.2 to 3; sensors' steps known of 0.45 to 0.85 and 0.05 to 0.45 of place.
constexpr double kLeastSingle = 1.4;  // variance about one quadric below which there is nothing to part
constexpr double kNats = 3;
constexpr double kMostLeftByPair = 1.25;
constexpr double kMostOfPlace = 0.12;  // of the variance of the sides, explained by the place
constexpr double kKnown = 0.6;
constexpr double kFarApart = 2.1;     // one point in 56 crosses the middle: patches of one sheet do as well
constexpr int kCells = 5;             // a side of the grid
constexpr double kMostMisfit = 1.5;   // mean square of a cell's mean, beside what noise makes
constexpr double kLeastInCell = 0.3;  // sum of squared weights
// By so much all points may be below what some of them show: four deviations of the variance of a hundred.
constexpr double kByChance = 1.6;

Vector6 quadric(const SheetPoint& p) {
  Vector6 f;
  f << 1, p.u, p.v, p.u * p.u, p.u * p.v, p.v * p.v;
  return f;
}

double side(const SheetPoint& p) {
  return 2 * p.upper - 1;
}

double probability(double above, double apart, double variance) {
  constexpr double kMost = 50;
  return 1 / (1 + std::exp(std::clamp(-2 * above * apart / variance, -kMost, kMost)));
}

}  // namespace

SheetPair::SheetPair(std::vector<SheetPoint>& points) {
  for (const SheetPoint& p : points) weights_ += p.weight;
  if (weights_ < kLeastWeights) return;
  fit_one(points);
  possible_ = kByChance * single_ > kLeastSingle;
  if (!(single_ > kLeastSingle)) return;
  fit_two(points);
  if (middle_.allFinite() && apart_.allFinite()) judge(points);
}

double SheetPair::middle(const SheetPoint& p) const {
  return middle_.dot(quadric(p));
}

double SheetPair::apart(const SheetPoint& p) const {
  return apart_[0] + apart_[1] * p.u + apart_[2] * p.v;
}

void SheetPair::fit_one(std::vector<SheetPoint>& points) {
  Matrix6 a = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  for (const SheetPoint& p : points) {
    const Vector6 f = quadric(p);
    a.noalias() += p.weight * f * f.transpose();
    right += p.weight * p.height * f;
  }
  a.diagonal().array() += kRidgeOfPair * weights_;
  const SmallCholesky<6> factors(a);
  normal_ = factors.inverse();
  middle_ = factors.solve(right);
  for (const SheetPoint& p : points) single_ += p.weight * std::pow(p.height - middle(p), 2);
  single_ /= weights_;
  const double apart = std::sqrt(std::max(0.0, single_ - 1));
  for (SheetPoint& p : points) p.upper = probability(p.height - middle(p), apart, 1);
}

void SheetPair::fit_two(std::vector<SheetPoint>& points) {
  for (int round = 0; round < kPairRounds; ++round) {
    Matrix9 a = Matrix9::Zero();
    Vector9 right = Vector9::Zero();
    for (const SheetPoint& p : points) {
      if (p.weight == 0) continue;
      Vector9 f;
      f << quadric(p), side(p), side(p) * p.u, side(p) * p.v;
      a.noalias() += p.weight * f * f.transpose();
      right += p.weight * p.height * f;
    }
    a.diagonal().array() += kRidgeOfPair * weights_;
    const Vector9 x = SmallCholesky<9>(a).solve(right);
    const double up = x[6] < 0 ? -1 : 1;  // the upper one is the one above
    middle_ = x.head<6>();
    apart_ = up * x.tail<3>();
    double squares = 0;
    for (SheetPoint& p : points) {
      const double above = p.height - middle(p), d = apart(p);
      p.upper = probability(above, d, variance_);
      squares += p.weight * (p.upper * std::pow(above - d, 2) + (1 - p.upper) * std::pow(above + d, 2));
    }
    left_ = squares / (weights_ - kUnknowns);
    variance_ = std::clamp(left_, kLeastVariance, 1.0);
  }
}

void SheetPair::judge(const std::vector<SheetPoint>& points) {
  struct Cell {
    double middle = 0, apart = 0, squares = 0;  // residuals times weights, squared weights
  };
  std::array<std::array<Cell, kCells>, kCells> cells;
  const auto cell_of = [](double u) {
    return std::size_t(std::clamp((u + 1) * kCells / 2, 0.0, kCells - 1.0));
  };
  double two = 0, known = 0, all = 0, sides = 0, squares = 0;
  Vector6 place = Vector6::Zero();
  for (const SheetPoint& p : points) {
    if (p.weight == 0) continue;
    const double above = p.height - middle(p), d = apart(p);
    two += p.weight * (std::log(0.5 * std::exp(-0.5 * std::pow(above - d, 2) / variance_) +
                                0.5 * std::exp(-0.5 * std::pow(above + d, 2) / variance_) + 1e-300) -
                       0.5 * std::log(variance_));
    known += p.weight * (p.estimate - middle(p)) * side(p);
    all += p.weight * d * side(p) * side(p);
    sides += p.weight * side(p);
    squares += p.weight * side(p) * side(p);
    place += p.weight * side(p) * quadric(p);
    Cell& cell = cells[cell_of(p.u)][cell_of(p.v)];
    cell.middle += p.weight * (above - side(p) * d);
    cell.apart += p.weight * (side(p) * above - d);
    cell.squares += p.weight * p.weight;
  }
  const double one = -0.5 * weights_ * (std::log(single_) + 1);
  const double mean = sides * sides / weights_;
  const double of_place = place.dot(normal_ * place) - mean;
  double misfit = 0;
  int counted = 0;
  for (const auto& row : cells)
    for (const Cell& cell : row) {
      if (cell.squares < kLeastInCell) continue;
      misfit += (cell.middle * cell.middle + cell.apart * cell.apart) / (cell.squares * variance_);
      counted += 2;
    }
  possible_ = left_ < kByChance * kMostLeftByPair && misfit < kByChance * kMostMisfit * counted;
  convincing_ = two - one > kNats && left_ < kMostLeftByPair && misfit < kMostMisfit * counted &&
                of_place < kMostOfPlace * (squares - mean) && apart_[0] < kFarApart && known > kKnown * all;
}

}  // namespace rfsmooth::rfs_mesh
