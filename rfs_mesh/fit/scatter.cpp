#include "rfs_mesh/fit/scatter.h"

#include <algorithm>
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
constexpr int kScatterRounds = 3;     // the first without a window

typedef double FourSums __attribute__((vector_size(4 * sizeof(double))));

/// Axes of least to most spread of the points about `place`, nearer ones weighing more. `breadth`: as in
/// Scatter.
Eigen::Matrix3d axes_of(const Positions& points, const std::vector<Neighbor>& near,
                        const Eigen::Vector3d& place, double r, double& breadth) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double weights = 0;
  for (const Neighbor& q : near) {
    const Eigen::Vector3d d = (points[q.index] - place) / r;
    const double inside = 1 - d.squaredNorm(), w = inside * inside;
    sum += w * d;
    spread += w * d * d.transpose();
    weights += w;
  }
  spread -= sum * sum.transpose() / weights;
  const SymmetricEigen<3> eigen = symmetric_eigen(spread);
  breadth = eigen.values[2] > 0 ? std::max(0.0, eigen.values[1]) / eigen.values[2] : 0;
  return eigen.vectors;
}

/// How far u, v, z lies above the quadric c.
double residual(const Eigen::Vector3d& x, const Eigen::Matrix<double, 6, 1>& c) {
  const double u = x.x(), v = x.y();
  const Eigen::Matrix<double, 6, 1> f(1, u, v, u * u, u * v, v * v);
  return x.z() - f.dot(c);
}

}  // namespace

double variance_inside(double c) {
  return 1 - 2 * c * std::exp(-c * c / 2) / std::sqrt(2 * M_PI) / std::erf(c / std::sqrt(2));
}

double ScatterFit::err_together(const Vector6& c) {
  // Along the patch, not in space: beside a point far above the others its nearest are above, too.
  nearest_ = local_;
  std::nth_element(nearest_.begin(), nearest_.begin() + kRing, nearest_.end(),
                   [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
                     return a.head<2>().squaredNorm() < b.head<2>().squaredNorm();
                   });
  int sum = 0;
  for (std::size_t i = 0; i < kRing; ++i) {
    sum += residual(nearest_[i], c) > 0 ? 1 : -1;
  }
  return double(sum * sum) / double(kRing);
}

void ScatterFit::look_at(const Vector6& c, Scatter& s) const {
  double weights = 0, second = 0, third = 0, fourth = 0, middle = 0;
  for (std::size_t i = 0; i < local_.size(); ++i) {
    const double e = residual(local_[i], c), w = weight_[i];
    weights += w;
    second += w * e * e;
    third += w * e * e * e;
    fourth += w * e * e * e * e;
  }
  if (!(second > 0)) return;
  for (std::size_t i = 0; i < local_.size(); ++i) {
    const double e = 2 * residual(local_[i], c);
    if (e * e * weights < second) middle += weight_[i];
  }
  s.flatness = fourth * weights / (second * second);
  s.lean = third * third * weights / (second * second * second);
  s.middle = middle / weights;
}

double ScatterFit::gather(const Positions& points, const Eigen::Vector3d& place, const Eigen::Matrix3d& axes,
                          double r, double flat, bool line) {
  local_.clear();
  weight_.clear();
  double all = 0;
  for (const Neighbor& q : near_) {
    const Eigen::Vector3d d = (points[q.index] - place) / r;
    const Eigen::Vector3d x(axes.col(2).dot(d) / flat, line ? 0 : axes.col(1).dot(d) / flat,
                            axes.col(0).dot(d));
    const double inside = 1 - x.head<2>().squaredNorm();
    if (inside <= 0) continue;
    local_.push_back(x);
    weight_.push_back(inside * inside);
    all += inside * inside;
  }
  return all;
}

RFSMOOTH_AVX2
void ScatterFit::sum_within(double window, const Vector6& c, bool first, bool last, Sums& sums) const {
  const double q[6] = {c[0], c[1], c[2], c[3], c[4], c[5]};
  // Of the columns of a and b: the first four rows, and of both together the last two.
  FourSums a[4] = {}, b[4] = {}, ends[6] = {}, right = {}, right_end = {};
  for (std::size_t i = 0; i < local_.size(); ++i) {
    const double u = local_[i].x(), v = local_[i].y(), z = local_[i].z();
    // Before there is a window, height weighs too: a second sheet at the rim of the ball must not pull.
    const double low = 1 - z * z;
    const double w = first ? weight_[i] * (last ? low * low : low) : weight_[i];
    const double f[6] = {1, u, v, u * u, u * v, v * v};
    const double height = (q[0] + (f[2] * q[2] + f[4] * q[4])) + (f[1] * q[1] + (f[3] * q[3] + f[5] * q[5]));
    if (std::abs(z - height) > window) continue;
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
                               double sigma, KeptNeighbors* kept) {
  static const double kInside = variance_inside(kScatterWindow);
  const Positions& points = index.points();
  if (kept != nullptr)
    kept->nearest(index, place, m, near_);
  else
    index.nearest(place, int(m), near_);
  Scatter s;
  s.foot = place;
  s.radius = std::sqrt(near_.back().squared_distance);
  if (!(s.radius > 0)) return s;
  const double r = 1.1 * s.radius;  // the farthest neighbour keeps a little weight
  Eigen::Matrix3d axes = axes_of(points, near_, place, r, s.breadth);
  const bool line = s.breadth < kLine;
  if (line) axes.col(0).swap(axes.col(1));
  const double high = kScatterWindow * sigma / r;
  const double flat = std::sqrt(std::max(kLeastFlat * kLeastFlat, 1 - high * high));
  const double all = gather(points, place, axes, r, flat, line);
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
    if (!(sigma > 0) && local_.size() > kRing) {
      s.together = err_together(c);
      look_at(c, s);
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
