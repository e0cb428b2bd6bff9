#include "tests/bench/scans/plane_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace rfsmooth::bench {
namespace {

constexpr double kShare = 0.8;
constexpr double kDeviations = 1.2816;  // within so many are 80 % of Gaussian numbers

double deviation_of(const Plane& plane, const Positions& points, const std::vector<Index>& rows,
                    std::vector<double>& room) {
  room.clear();
  for (const Index i : rows) room.push_back(std::abs(plane.height(points[i])));
  const auto at = room.begin() + std::ptrdiff_t(kShare * double(room.size()));
  std::nth_element(room.begin(), at, room.end());
  return *at / kDeviations;
}

}  // namespace

std::array<Eigen::Vector3d, 2> Plane::axes() const {
  Eigen::Index least = 0;
  normal.cwiseAbs().minCoeff(&least);
  const Eigen::Vector3d u = normal.cross(Eigen::Vector3d::Unit(least)).normalized();
  return {u, normal.cross(u)};
}

Plane fit_plane(const Positions& points, const std::vector<Index>& rows) {
  if (rows.size() < 3) throw std::invalid_argument("a plane needs three points");
  Plane plane;
  for (const Index i : rows) plane.point += points[i];
  plane.point /= double(rows.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Index i : rows) scatter += (points[i] - plane.point) * (points[i] - plane.point).transpose();
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  return plane;
}

double robust_deviation(const Plane& plane, const Positions& points, const std::vector<Index>& rows) {
  std::vector<double> room;
  return deviation_of(plane, points, rows, room);
}

Plane fit_plane_trimmed(const Positions& points, const std::vector<Index>& rows) {
  Plane plane = fit_plane(points, rows);
  for (int pass = 0; pass < 3; ++pass) {
    const double reach = 3 * robust_deviation(plane, points, rows);
    std::vector<Index> kept;
    for (const Index i : rows)
      if (std::abs(plane.height(points[i])) <= reach) kept.push_back(i);
    if (kept.size() < 3) return plane;
    plane = fit_plane(points, kept);
  }
  return plane;
}

Plane draw_plane(const Positions& points, const std::vector<Index>& rows, int draws, clouds::Random& random) {
  const auto any = [&] { return points[rows[std::size_t(random.uniform() * double(rows.size()))]]; };
  Plane best;
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> room;
  for (int draw = 0; draw < draws; ++draw) {
    Plane plane;
    plane.point = any();
    const Eigen::Vector3d a = any() - plane.point, b = any() - plane.point, across = a.cross(b);
    if (across.norm() <= 0.1 * a.norm() * b.norm()) continue;  // nearly in line, or one point twice
    plane.normal = across.normalized();
    const double deviation = deviation_of(plane, points, rows, room);
    if (deviation >= least) continue;
    least = deviation;
    best = plane;
  }
  return best;
}

bool is_flat(const Plane& plane, const Positions& points, const std::vector<Index>& rows) {
  using Row = Eigen::Matrix<double, 6, 1>;
  const auto [u, v] = plane.axes();
  double scale = 0, flat = 0;
  for (const Index i : rows) scale = std::max(scale, (points[i] - plane.point).norm());
  const auto terms = [&, u = u, v = v](Index i) -> Row {
    const double x = u.dot(points[i] - plane.point) / scale, y = v.dot(points[i] - plane.point) / scale;
    return (Row() << 1, x, y, x * x, x * y, y * y).finished();
  };
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Row right = Row::Zero();
  for (const Index i : rows) {
    const Row t = terms(i);
    const double h = plane.height(points[i]);
    normal += t * t.transpose();
    right += h * t;
    flat += h * h;
  }
  const Row fit = normal.ldlt().solve(right);
  double bent = 0;
  for (const Index i : rows) {
    const double off = plane.height(points[i]) - fit.dot(terms(i));
    bent += off * off;
  }
  return bent >= 0.64 * flat;
}

}  // namespace rfsmooth::bench
