#include "rfsmooth/rfs_mesh/local_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kSmallestQuadric = 8;  ///< two more than its six coefficients
constexpr int kRobustRounds = 2;  ///< re-weightings after the first fit; more changes nothing visible
constexpr double kTukey = 4.685;  ///< biweight cut-off in sigmas: 95 % efficient on Gaussian noise
constexpr double kRidge = 1e-9;   ///< relative; keeps collinear and gridded neighbourhoods solvable

/// One neighbour: offset from p and its weight.
struct Sample {
  Vector3d d;
  double weight;
};

/// Room for the neighbours of one point, reused along a block so that nothing is allocated per point.
struct Workspace {
  std::vector<Sample> samples;
  std::vector<Vector3d> local;  ///< (u, v, z) / R
  std::vector<double> residual, sorted;
};

/// The nearest neighbours of one point without itself, in memory that is kept.
class NearestOthers {
 public:
  const std::vector<Index>& find(const SpatialIndex& index, std::size_t i, std::size_t count) {
    index.nearest(index.points()[i], int(count) + 1, found_);
    row_.clear();
    for (const Neighbor& q : found_)
      if (q.index != i) row_.push_back(q.index);
    return row_;
  }

 private:
  std::vector<Neighbor> found_;
  std::vector<Index> row_;
};

double square(double x) {
  return x * x;
}

Matrix3d weighted_covariance(const std::vector<Sample>& samples) {
  double total = 0;
  Vector3d mean = Vector3d::Zero();
  for (const Sample& s : samples) {
    mean += s.weight * s.d;
    total += s.weight;
  }
  mean /= total;
  Matrix3d c = Matrix3d::Zero();
  for (const Sample& s : samples) {
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

/// The quadric's height above the tangent plane at (u, v).
double height(const Vector6d& c, double u, double v) {
  return c[0] + u * (c[1] + c[3] * u + c[4] * v) + v * (c[2] + c[5] * v);
}

/// Weighted least squares of z on the first `terms` monomials (3 = plane, 6 = quadric).
/// The normal matrix holds moments u^p v^q of degree 0 to 4 only: 15 sums instead of 36.
Vector6d fit(const Workspace& w, int terms) {
  double m00 = 0, m10 = 0, m01 = 0, m20 = 0, m11 = 0, m02 = 0, m30 = 0, m21 = 0, m12 = 0, m03 = 0, m40 = 0,
         m31 = 0, m22 = 0, m13 = 0, m04 = 0;
  double z0 = 0, zu = 0, zv = 0, zuu = 0, zuv = 0, zvv = 0;
  for (std::size_t j = 0; j < w.samples.size(); ++j) {
    const double weight = w.samples[j].weight, u = w.local[j][0], v = w.local[j][1], z = w.local[j][2];
    const double uu = u * u, uv = u * v, vv = v * v;
    const double wu = weight * u, wv = weight * v, wuu = weight * uu, wuv = weight * uv, wvv = weight * vv;
    m00 += weight;
    m10 += wu;
    m01 += wv;
    m20 += wuu;
    m11 += wuv;
    m02 += wvv;
    m30 += wuu * u;
    m21 += wuu * v;
    m12 += wvv * u;
    m03 += wvv * v;
    m40 += wuu * uu;
    m31 += wuu * uv;
    m22 += wuu * vv;
    m13 += wvv * uv;
    m04 += wvv * vv;
    z0 += weight * z;
    zu += wu * z;
    zv += wv * z;
    zuu += wuu * z;
    zuv += wuv * z;
    zvv += wvv * z;
  }
  Matrix6d a;
  a << m00, m10, m01, m20, m11, m02,  //
      m10, m20, m11, m30, m21, m12,   //
      m01, m11, m02, m21, m12, m03,   //
      m20, m30, m21, m40, m31, m22,   //
      m11, m21, m12, m31, m22, m13,   //
      m02, m12, m03, m22, m13, m04;
  Vector6d b;
  b << z0, zu, zv, zuu, zuv, zvv;
  for (int t = terms; t < 6; ++t) {
    a.row(t).setZero();
    a.col(t).setZero();
    a(t, t) = 1;
    b[t] = 0;
  }
  a.diagonal().array() += kRidge * m00;
  return a.llt().solve(b);
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Tukey's biweight on top of the distance weights; returns false if the residuals leave nothing to do.
bool reweight(Workspace& w, const Vector6d& c) {
  w.residual.resize(w.samples.size());
  for (std::size_t j = 0; j < w.samples.size(); ++j)
    w.residual[j] = std::abs(w.local[j][2] - height(c, w.local[j][0], w.local[j][1]));
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
double residual_deviation(const Workspace& w, const Vector6d& c, int terms) {
  double sum = 0, total = 0, squares = 0;
  for (std::size_t j = 0; j < w.samples.size(); ++j) {
    const double weight = w.samples[j].weight;
    sum += weight * square(w.local[j][2] - height(c, w.local[j][0], w.local[j][1]));
    total += weight;
    squares += weight * weight;
  }
  if (!(squares > 0)) return 0;
  const double effective = total * total / squares;
  return std::sqrt(sum / total * effective / std::max(1.0, effective - terms));
}

double larger_principal_curvature(const Vector6d& c) {
  const double mean = c[3] + c[5], half = std::hypot(c[3] - c[5], c[4]);
  return std::abs(mean) + half;
}

LocalSurface fit_surface(const Positions& points, const Vector3d& p, const Index* neighbours,
                         std::size_t count, Workspace& w, int robust_rounds = kRobustRounds) {
  LocalSurface surface{Vector3d::UnitZ(), p};
  double reach = 0;
  w.samples.clear();
  w.samples.push_back({Vector3d::Zero(), 1});
  for (std::size_t j = 0; j < count; ++j) {
    w.samples.push_back({points[neighbours[j]] - p, 1});
    reach = std::max(reach, w.samples.back().d.norm());
  }
  if (!(reach > 0)) return surface;
  constexpr double kBeyond = 1.1;  // the farthest neighbour keeps a little weight
  const double r = kBeyond * reach;
  for (Sample& s : w.samples) {
    s.d /= r;
    s.weight = square(1 - s.d.squaredNorm());
  }
  const Matrix3d axes = principal_axes(weighted_covariance(w.samples));
  const Vector3d n = axes.col(0), t1 = axes.col(2), t2 = n.cross(t1);
  surface.normal = n;
  if (count < 3) return surface;

  w.local.resize(w.samples.size());
  for (std::size_t j = 0; j < w.samples.size(); ++j)
    w.local[j] = {t1.dot(w.samples[j].d), t2.dot(w.samples[j].d), n.dot(w.samples[j].d)};
  const int terms = count >= kSmallestQuadric ? 6 : 3;
  Vector6d c = fit(w, terms);
  for (int round = 0; terms == 6 && round < robust_rounds && reweight(w, c); ++round) c = fit(w, terms);
  if (!c.allFinite()) return surface;

  surface.normal = (n - c[1] * t1 - c[2] * t2).normalized();
  surface.shadow = p + (r * c[0] * n.dot(surface.normal)) * surface.normal;
  surface.curvature = larger_principal_curvature(c) / r;
  surface.residual = r * residual_deviation(w, c, terms);
  return surface;
}

}  // namespace

LocalSurface fit_local_surface(const Positions& points, const Vector3d& p, const Index* neighbours,
                               std::size_t count) {
  Workspace workspace;
  return fit_surface(points, p, neighbours, count, workspace);
}

std::vector<LocalSurface> local_surfaces(const Positions& points, const NeighborTable& near,
                                         const Context& context) {
  std::vector<LocalSurface> surfaces(points.size());
  for_blocks(context, points.size(), 1024, [&](std::size_t begin, std::size_t end) {
    Workspace workspace;
    for (std::size_t i = begin; i < end; ++i) {
      const auto row = near[i];
      surfaces[i] = fit_surface(points, points[i], row.begin(), row.size(), workspace);
    }
  });
  return surfaces;
}

std::vector<LocalSurface> wide_local_surfaces(const SpatialIndex& index, const NoiseScale& scale,
                                              std::size_t least, const Context& context) {
  constexpr double kMisfit = 1.4;  // well above what the residual of pure noise scatters
  const Positions& points = index.points();
  std::vector<LocalSurface> surfaces(points.size());
  for_blocks(context, points.size(), 256, [&](std::size_t begin, std::size_t end) {
    Workspace workspace;
    NearestOthers nearest;
    for (std::size_t i = begin; i < end; ++i) {
      const auto& row = nearest.find(index, i, scale.neighbours);
      std::size_t count = row.size();
      surfaces[i] = fit_surface(points, points[i], row.data(), count, workspace);
      while (surfaces[i].residual > kMisfit * scale.sigma && count / 2 >= least) {
        count /= 2;
        surfaces[i] = fit_surface(points, points[i], row.data(), count, workspace);
      }
    }
  });
  return surfaces;
}

double mean_spacing(const Positions& points, const NeighborTable& near, const Context& context) {
  if (points.size() < 2) return 0;
  return sum_over(context, points.size(), 0.0,
                  [&](std::size_t i) { return (points[near[i][0]] - points[i]).norm(); }) /
         double(points.size());
}

namespace {

/// The lower quartile of the root of a chi-square variable over its degrees of freedom (Wilson & Hilferty).
double quartile_of_deviation(double freedom) {
  const double v = 2 / (9 * freedom);
  return std::pow(std::max(0.1, 1 - v - 0.6745 * std::sqrt(v)), 1.5);
}

struct Deviation {
  double sigma, radius;
};

/// The flat places' residual and the median radius of neighbourhoods of m.
Deviation deviation_at(const SpatialIndex& index, std::size_t m, const Context& context) {
  constexpr std::size_t kSamples = 1000;
  constexpr double kEffective = 5.0 / 9;  // what the distance weights leave of m samples on a disk
  const std::size_t n = index.points().size(), samples = std::min(n, kSamples);
  std::vector<double> residuals(samples), radii(samples);
  for_blocks(context, samples, 16, [&](std::size_t begin, std::size_t end) {
    Workspace workspace;
    NearestOthers nearest;
    for (std::size_t s = begin; s < end; ++s) {
      const std::size_t i = s * n / samples;
      const Positions& points = index.points();
      const auto& row = nearest.find(index, i, m);
      residuals[s] = fit_surface(points, points[i], row.data(), row.size(), workspace, 0).residual;
      radii[s] = row.empty() ? 0 : (points[row.back()] - points[i]).norm();
    }
  });
  const auto quartile = residuals.begin() + std::ptrdiff_t(samples / 4);
  std::nth_element(residuals.begin(), quartile, residuals.end());
  return {*quartile / quartile_of_deviation(std::max(1.0, kEffective * double(m + 1) - 6)), median(radii)};
}

}  // namespace

NoiseScale noise_scale(const SpatialIndex& index, const Context& context) {
  constexpr std::size_t kNarrowest = 24, kWidest = 384;
  constexpr double kShareOfRadius = 0.18;
  constexpr double kGrowthOfNoise = 1.26;  // cube root of 2: a ball inside a slab; faster growth is shape
  const std::size_t n = index.points().size();
  NoiseScale best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t m = kNarrowest; m <= kWidest && m < n; m *= 2) {
    const Deviation d = deviation_at(index, m, context);
    if (best.neighbours > 0 && d.sigma > kGrowthOfNoise * best.sigma) break;
    const double share = d.radius > 0 ? d.sigma / d.radius : 0;
    if (share < least) {
      least = share;
      best = {d.sigma, m};
    }
    if (share <= kShareOfRadius) break;
  }
  return best;
}

}  // namespace rfsmooth::rfs_mesh
