#include "rfsmooth/rfs_mesh/quadric.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "rfsmooth/rfs_mesh/median.h"
#include "rfsmooth/rfs_mesh/quadric_moments.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kSmallestQuadric = 8;  ///< two more than its six coefficients
constexpr double kTukey = 4.685;             ///< biweight cut-off in sigmas: 95 % efficient on Gaussian noise
constexpr double kRidge = 1e-9;  ///< relative; keeps collinear and gridded neighbourhoods solvable

double square(double x) {
  return x * x;
}

Matrix3d weighted_covariance(const std::vector<QuadricWorkspace::Sample>& samples) {
  double total = 0;
  Vector3d mean = Vector3d::Zero();
  for (const auto& s : samples) {
    mean += s.weight * s.d;
    total += s.weight;
  }
  mean /= total;
  Matrix3d c = Matrix3d::Zero();
  for (const auto& s : samples) {
    const Vector3d d = s.d - mean;
    c.noalias() += (s.weight * d) * d.transpose();
  }
  return c;
}

/// The eigenvectors of a symmetric matrix, smallest eigenvalue first.
Matrix3d principal_axes(const Matrix3d& covariance) {
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
  solver.computeDirect(covariance);
  Matrix3d axes = solver.eigenvectors();
  if (!axes.allFinite() || std::abs(std::abs(axes.determinant()) - 1) > 1e-6) {
    solver.compute(covariance);  // the closed form loses accuracy where two eigenvalues nearly meet
    axes = solver.eigenvectors();
  }
  return axes;
}

/// Weighted least squares of z on the first `terms` monomials (3 = plane, 6 = quadric).
Vector6d fit(const QuadricWorkspace& w, int terms) {
  QuadricMoments<double> moments;
  QuadricHeights<double> heights;
  for (std::size_t j = 0; j < w.samples.size(); ++j) {
    const double weight = w.samples[j].weight, u = w.local[j][0], v = w.local[j][1], z = w.local[j][2];
    moments.add(u, v, weight);
    heights.add(u, v, weight * z);
  }
  const auto itself = [](double sum) { return sum; };
  Matrix6d a = moments.matrix(itself);
  Vector6d b = heights.vector(itself);
  const double total = a(0, 0);
  for (int t = terms; t < 6; ++t) {
    a.row(t).setZero();
    a.col(t).setZero();
    a(t, t) = 1;
    b[t] = 0;
  }
  a.diagonal().array() += kRidge * total;
  return a.llt().solve(b);
}

/// Tukey's biweight on top of the distance weights; returns false if the residuals leave nothing to do.
bool reweight(QuadricWorkspace& w, const Quadric& q) {
  w.residual.resize(w.samples.size());
  for (std::size_t j = 0; j < w.samples.size(); ++j)
    w.residual[j] = std::abs(w.local[j][2] - q.height(w.local[j][0], w.local[j][1]));
  w.sorted = w.residual;
  const double cut = kTukey * 1.4826 * median(w.sorted);
  if (!(cut > 1e-12)) return false;
  for (std::size_t j = 0; j < w.samples.size(); ++j) {
    const double distance = square(1 - w.local[j].squaredNorm());
    w.samples[j].weight = w.residual[j] < cut ? distance * square(1 - square(w.residual[j] / cut)) : 0;
  }
  return true;
}

/// Weighted residual sum over the degrees of freedom the weights leave.
double residual_deviation(const QuadricWorkspace& w, const Quadric& q, int terms) {
  double sum = 0, total = 0, squares = 0;
  for (std::size_t j = 0; j < w.samples.size(); ++j) {
    const double weight = w.samples[j].weight;
    sum += weight * square(w.local[j][2] - q.height(w.local[j][0], w.local[j][1]));
    total += weight;
    squares += weight * weight;
  }
  if (!(squares > 0)) return 0;
  const double effective = total * total / squares;
  return std::sqrt(sum / total * effective / std::max(1.0, effective - terms));
}

}  // namespace

Quadric fit_quadric(const Positions& points, const Vector3d& p, const Index* neighbours, std::size_t count,
                    QuadricWorkspace& w, int robust_rounds) {
  Quadric q;
  q.centre = p;
  double reach = 0;
  w.samples.clear();
  w.samples.push_back({Vector3d::Zero(), 1});
  for (std::size_t j = 0; j < count; ++j) {
    w.samples.push_back({points[neighbours[j]] - p, 1});
    reach = std::max(reach, w.samples.back().d.norm());
  }
  if (!(reach > 0)) return q;
  constexpr double kBeyond = 1.1;  // the farthest neighbour keeps a little weight
  const double r = kBeyond * reach;
  for (auto& s : w.samples) {
    s.d /= r;
    s.weight = square(1 - s.d.squaredNorm());
  }
  const Matrix3d axes = principal_axes(weighted_covariance(w.samples));
  q.n = axes.col(0);
  q.t1 = axes.col(2);
  q.t2 = q.n.cross(q.t1);
  if (count < 3) return q;

  w.local.resize(w.samples.size());
  for (std::size_t j = 0; j < w.samples.size(); ++j)
    w.local[j] = {q.t1.dot(w.samples[j].d), q.t2.dot(w.samples[j].d), q.n.dot(w.samples[j].d)};
  const int terms = count >= kSmallestQuadric ? 6 : 3;
  q.c = fit(w, terms);
  for (int round = 0; terms == 6 && round < robust_rounds && reweight(w, q); ++round) q.c = fit(w, terms);
  if (!q.c.allFinite()) {
    q.c.setZero();
    return q;
  }
  q.radius = r;
  q.residual = r * residual_deviation(w, q, terms);
  return q;
}

}  // namespace rfsmooth::rfs_mesh
