#include "rfs_mesh/fit/scatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "base/avx2.h"
#include "base/linear/symmetric_eigen.h"
#include "rfs_mesh/levels.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr double kLeastKept = 0.75;   // of the weight; 3 sigma of half the true sigma keep 0.87
constexpr double kLeastWithin = 0.2;  // of the weight: what a window of a quarter of sigma keeps
constexpr double kLeastFlat = 0.5;    // the patch's radius over the ball's, where the window is high
constexpr double kFarOff = 2.24;      // deviations, beyond which a fortieth of normal residuals lie
constexpr int kScatterRounds = 3;     // the first without a window

typedef double FourSums __attribute__((vector_size(4 * sizeof(double))));

/// The heights of a quadric, by numbers of its own: while it is asked, no store to a buffer can change them.
class Heights {
 public:
  explicit Heights(const Eigen::Matrix<double, 6, 1>& c) : q_{c[0], c[1], c[2], c[3], c[4], c[5]} {}
  double operator()(double u, double v) const {
    return (q_[0] + (v * q_[2] + u * v * q_[4])) + (u * q_[1] + (u * u * q_[3] + v * v * q_[5]));
  }

 private:
  double q_[6];
};

}  // namespace

double variance_inside(double c) {
  return 1 - 2 * c * std::exp(-c * c / 2) / std::sqrt(2 * M_PI) / std::erf(c / std::sqrt(2));
}

RFSMOOTH_AVX2
void ScatterFit::find_residuals(const Vector6& c) {
  const Heights heights(c);
  for (std::size_t i = 0; i < u_.size(); ++i) residual_[i] = z_[i] - heights(u_[i], v_[i]);
}

void ScatterFit::find_nearest() {
  // Along the patch, not in space: beside a point far above the others its nearest are above, too.
  by_distance_.clear();
  for (std::size_t i = 0; i < u_.size(); ++i) by_distance_.emplace_back(u_[i] * u_[i] + v_[i] * v_[i], i);
  const auto near = by_distance_.begin() + std::ptrdiff_t(std::min(kNeighbourhood, by_distance_.size()));
  std::nth_element(by_distance_.begin(), near, by_distance_.end());
  std::nth_element(by_distance_.begin(), by_distance_.begin() + kRing, near);
  nearest_.clear();
  disk_ = 0;
  for (auto of = by_distance_.begin(); of != near; ++of) {
    const std::size_t i = of->second;
    nearest_.push_back({u_[i], v_[i], residual_[i] > 0 ? 1.0 : -1.0});
    disk_ = std::max(disk_, of->first);
  }
}

double ScatterFit::err_together() const {
  double sum = 0;
  for (std::size_t k = 0; k < kRing; ++k) sum += nearest_[k].off;
  return sum * sum / double(kRing);
}

void ScatterFit::look_at_rows(Scatter& s) const {
  double mean = 0;
  for (const Side& p : nearest_) mean += p.off / double(nearest_.size());
  const double variance = 1 - mean * mean;
  if (!(variance > 0)) {
    s.in_row = s.next_row = 1;
    return;
  }
  double along = 0, aside = 0, pairs = 0;
  for (std::size_t k = 0; k < nearest_.size(); ++k)
    for (std::size_t l = 0; l < k; ++l) {
      const Side &p = nearest_[k], &q = nearest_[l];
      const double u = p.u - q.u, v = p.v - q.v, square = u * u + v * v;
      if (!(square > 0)) continue;
      const double alike = (p.off - mean) * (q.off - mean) / (variance * square);
      along += alike * (u * u - v * v);
      aside += alike * 2 * u * v;
      ++pairs;
    }
  if (!(pairs > 0)) return;
  s.in_rows = (along * along + aside * aside) / pairs;
  // The rows' direction is half of that angle; x and y are along and across them.
  const double angle = std::atan2(aside, along) / 2, x = std::cos(angle), y = std::sin(angle);
  std::array<double, 2> products = {}, counts = {};
  for (std::size_t k = 0; k < nearest_.size(); ++k)
    for (std::size_t l = 0; l < k; ++l) {
      const Side &p = nearest_[k], &q = nearest_[l];
      const double across = x * (p.v - q.v) - y * (p.u - q.u);
      if (4 * across * across >= disk_) continue;
      const std::size_t next = 16 * across * across < disk_ ? 0 : 1;
      products[next] += p.off * q.off;
      ++counts[next];
    }
  s.in_row = products[0] / std::max(1.0, counts[0]);
  s.next_row = products[1] / std::max(1.0, counts[1]);
}

double ScatterFit::lie_beside() const {
  constexpr double kByChance = 0.125;
  const auto count = double(nearest_.size());
  double above = 0;
  for (const Side& p : nearest_) above += double(p.off > 0);
  if (!(above > 0 && above < count)) return 1;
  // Of points at random, so many over an area pi r^2, none lies within r of a place with exp(-their number).
  const double squares = -std::log(1 - kByChance) * disk_, of_above = squares / above,
               of_below = squares / (count - above);
  double beside = 0;
  for (const Side& p : nearest_) {
    const double reach = p.off > 0 ? of_below : of_above;
    beside += double(std::any_of(nearest_.begin(), nearest_.end(), [&](const Side& q) {
      return q.off != p.off && (q.u - p.u) * (q.u - p.u) + (q.v - p.v) * (q.v - p.v) < reach;
    }));
  }
  return beside / (kByChance * count);
}

void ScatterFit::look_at_residuals(Scatter& s) const {
  double weights = 0, second = 0, third = 0, fourth = 0;
  for (std::size_t i = 0; i < residual_.size(); ++i) {
    const double e = residual_[i], w = weight_[i];
    weights += w;
    second += w * e * e;
    third += w * e * e * e;
    fourth += w * e * e * e * e;
  }
  if (!(second > 0)) return;
  s.flatness = fourth * weights / (second * second);
  s.lean = third * third * weights / (second * second * second);
  const double mean = second / weights, far = kFarOff * std::sqrt(mean);
  double middle = 0;
  Eigen::Array4d weight = Eigen::Array4d::Zero(), cubes = weight;  // of the quadrants
  for (std::size_t i = 0; i < residual_.size(); ++i) {
    const double e = std::clamp(residual_[i], -far, far), w = weight_[i];
    const int quadrant = (u_[i] > 0 ? 1 : 0) + (v_[i] > 0 ? 2 : 0);
    weight[quadrant] += w;
    cubes[quadrant] += w * e * e * e;
    middle += 4 * e * e < mean ? w : 0;
  }
  s.middle = middle / weights;
  const double pairs = weights * weights - weight.square().sum(), all = cubes.sum();
  if (pairs > 0) s.lean_in_common = (all * all - cubes.square().sum()) / (pairs * mean * mean * mean);
}

RFSMOOTH_AVX2
void ScatterFit::scale(const Positions& points, const Eigen::Vector3d& place, double r) {
  for (std::size_t i = 0; i < near_.size(); ++i) {
    const Eigen::Vector3d& p = points[near_[i].index];
    x_[i] = p[0] - place[0], y_[i] = p[1] - place[1], z_[i] = p[2] - place[2];
  }
  for (std::vector<double>* const values : {&x_, &y_, &z_})
    for (double& value : *values) value /= r;
}

Eigen::Matrix3d ScatterFit::find_axes(double& breadth) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();  // the lower triangle
  double weights = 0;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const double x = x_[i], y = y_[i], z = z_[i], inside = 1 - ((x * x + y * y) + z * z), w = inside * inside;
    const Eigen::Vector3d once = {w * x, w * y, w * z};
    sum += once;
    spread.col(0) += x * once;
    spread(1, 1) += y * once[1];
    spread(2, 1) += y * once[2];
    spread(2, 2) += z * once[2];
    weights += w;
  }
  spread -= sum * sum.transpose() / weights;
  const SymmetricEigen<3> eigen = symmetric_eigen(spread);
  breadth = eigen.values[2] > 0 ? std::max(0.0, eigen.values[1]) / eigen.values[2] : 0;
  return eigen.vectors;
}

RFSMOOTH_AVX2
void ScatterFit::turn(const Eigen::Matrix3d& axes, double flat, bool line) {
  const auto along = [](const double* axis, double x, double y, double z) {
    return (axis[0] * x + axis[1] * y) + axis[2] * z;
  };
  const double* const from = axes.data();
  const double least[3] = {from[0], from[1], from[2]}, middle[3] = {from[3], from[4], from[5]},
               most[3] = {from[6], from[7], from[8]};
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const double x = x_[i], y = y_[i], z = z_[i];
    u_[i] = along(most, x, y, z) / flat;
    v_[i] = line ? 0 : along(middle, x, y, z) / flat;
    z_[i] = along(least, x, y, z);
    weight_[i] = 1 - (u_[i] * u_[i] + v_[i] * v_[i]);
  }
}

double ScatterFit::keep_inside() {
  std::size_t count = 0;
  double all = 0;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const double inside = weight_[i];
    if (inside <= 0) continue;
    u_[count] = u_[i], v_[count] = v_[i], z_[count] = z_[i];
    weight_[count++] = inside * inside;
    all += inside * inside;
  }
  for (std::vector<double>* const values : {&u_, &v_, &z_, &weight_, &residual_}) values->resize(count);
  return all;
}

RFSMOOTH_AVX2
void ScatterFit::sum_within(double window, const Vector6& c, bool first, bool last, Sums& sums) const {
  const Heights heights(c);
  // Of the columns of a and b: the first four rows, and of both together the last two.
  FourSums a[4] = {}, b[4] = {}, ends[6] = {}, right = {}, right_end = {};
  for (std::size_t i = 0; i < u_.size(); ++i) {
    const double u = u_[i], v = v_[i], z = z_[i];
    // Before there is a window, height weighs too: a second sheet at the rim of the ball must not pull.
    const double low = 1 - z * z;
    const double w = first ? weight_[i] * (last ? low * low : low) : weight_[i];
    const double f[6] = {1, u, v, u * u, u * v, v * v};
    if (std::abs(z - heights(u, v)) > window) continue;
    const FourSums start = {f[0], f[1], f[2], f[3]}, end = {f[4], f[5], f[4], f[5]};
    for (int column = 0; column < 6; ++column) {
      const double once = w * f[column], twice = w * w * f[column];
      if (column < 4) {
        a[column] += once * start;
        b[column] += twice * start;
      }
      ends[column] += FourSums{once, once, twice, twice} * end;
    }
    right += w * z * start;
    right_end += w * z * end;
    sums.heights += w * z * z;
    sums.kept += w;
    sums.squares += w * w;
  }
  for (int column = 0; column < 6; ++column)
    for (int row = column; row < 6; ++row) {
      sums.a(row, column) = row < 4 ? a[column][row] : ends[column][row - 4];
      sums.b(row, column) = row < 4 ? b[column][row] : ends[column][row - 2];
    }
  for (int row = 0; row < 6; ++row) sums.right[row] = row < 4 ? right[row] : right_end[row - 4];
}

Scatter ScatterFit::operator()(const SpatialIndex& index, const Eigen::Vector3d& place, std::size_t m,
                               double sigma, KeptNeighbors& kept) {
  static const double kInside = variance_inside(kScatterWindow);
  kept.nearest(index, place, m, near_);
  Scatter s;
  s.foot = place;
  s.radius = std::sqrt(near_.back().squared_distance);
  if (!(s.radius > 0)) return s;
  const double r = kBeyond * s.radius;
  for (std::vector<double>* const values : {&x_, &y_, &z_, &u_, &v_, &weight_, &residual_})
    values->resize(near_.size());
  scale(index.points(), place, r);
  Eigen::Matrix3d axes = find_axes(s.breadth);
  const bool line = s.breadth < kLine;
  if (line) axes.col(0).swap(axes.col(1));
  const double high = kScatterWindow * sigma / r;
  const double flat = std::sqrt(std::max(kLeastFlat * kLeastFlat, 1 - high * high));
  turn(axes, flat, line);
  const double all = keep_inside();
  Vector6 c = Vector6::Zero();
  double window = std::numeric_limits<double>::infinity();
  bool silent = false;
  for (int round = 0; round < (sigma > 0 ? kScatterRounds : 1); ++round) {
    Sums sums;
    sum_within(window, c, round == 0, !(sigma > 0), sums);
    s.freedom = 0;
    s.foot = place;
    s.normal = axes.col(0);
    silent = round > 0 && sums.kept < kLeastKept * all;
    if (silent && sums.kept < kLeastWithin * all) return s;
    sums.a.diagonal().array() += 1e-9 * sums.kept;
    const Eigen::LLT<Matrix6> solver(sums.a.selfadjointView<Eigen::Lower>());
    c = solver.solve(sums.right);
    const Matrix6 full = sums.b.selfadjointView<Eigen::Lower>();
    const double left = sums.kept - solver.solve(full).trace();
    const double squares = sums.heights - sums.right.dot(c);
    if (!(left > 0.02 * sums.kept) || !std::isfinite(squares)) return s;
    if (!(sigma > 0) && u_.size() > kRing) {
      find_residuals(c);
      find_nearest();
      s.together = err_together();
      look_at_rows(s);
      s.beside = lie_beside();
      look_at_residuals(s);
    }
    s.variance = r * r * std::max(0.0, squares) / left / (round > 0 ? kInside : 1);
    s.freedom = left * left / sums.squares;
    s.foot = place + r * c[0] * axes.col(0);
    s.normal = (axes.col(0) - c[1] / flat * axes.col(2) - c[2] / flat * axes.col(1)).normalized();
    window = high;
  }
  if (says(s)) s.within = s.variance;
  if (silent) {
    s.freedom = 0;
    s.foot = place;
  }
  return s;
}

}  // namespace rfsmooth::rfs_mesh
