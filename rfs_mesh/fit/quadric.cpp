#include "rfs_mesh/fit/quadric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "base/avx2.h"
#include "base/linear/symmetric_eigen.h"
#include "base/quantile.h"
#include "rfs_mesh/fit/quadric_moments.h"
#include "rfs_mesh/levels.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kTukey = 4.685;  ///< biweight cut-off in sigmas: 95 % efficient on Gaussian noise
constexpr double kRidge = 1e-9;   ///< relative; keeps collinear and gridded neighbourhoods solvable

constexpr std::size_t kSideBySide = 4;
typedef double Lanes __attribute__((vector_size(kSideBySide * sizeof(double))));

const auto kTotal = [](const Lanes& l) { return (l[0] + l[1]) + (l[2] + l[3]); };

inline void load(const std::vector<double>& from, std::size_t at, Lanes& to) {
  std::memcpy(&to, from.data() + at, sizeof to);
}
inline void store(const Lanes& from, std::size_t at, std::vector<double>& to) {
  std::memcpy(to.data() + at, &from, sizeof from);
}

/// Turns x, y, z into units of `radius`, sets the weights by distance and the weighted covariance.
RFSMOOTH_AVX2
void weigh(QuadricWorkspace& w, double radius, Matrix3d& covariance) {
  const double scale = 1 / radius;
  Lanes sum[10] = {};
  for (std::size_t k = 0; k < w.padded; k += kSideBySide) {
    Lanes x, y, z;
    load(w.x, k, x);
    load(w.y, k, y);
    load(w.z, k, z);
    x *= scale;
    y *= scale;
    z *= scale;
    const Lanes inside = 1 - ((x * x + y * y) + z * z);
    Lanes weight = inside * inside;
    for (std::size_t lane = w.count; lane < k + kSideBySide; ++lane)
      if (lane >= k) weight[lane - k] = 0;  // no point but padding
    store(x, k, w.x);
    store(y, k, w.y);
    store(z, k, w.z);
    store(weight, k, w.nearness);
    const Lanes wx = weight * x, wy = weight * y, wz = weight * z;
    sum[0] += weight;
    sum[1] += wx;
    sum[2] += wy;
    sum[3] += wz;
    sum[4] += wx * x;
    sum[5] += wx * y;
    sum[6] += wx * z;
    sum[7] += wy * y;
    sum[8] += wy * z;
    sum[9] += wz * z;
  }
  double s[10];
  for (int t = 0; t < 10; ++t) s[t] = kTotal(sum[t]);
  const Vector3d mean = Vector3d(s[1], s[2], s[3]) / s[0];
  covariance << s[4], s[5], s[6], s[5], s[7], s[8], s[6], s[8], s[9];
  covariance -= s[0] * mean * mean.transpose();
}

/// Offsets in the frame of `q`.
RFSMOOTH_AVX2
void turn_into(const Quadric& q, QuadricWorkspace& w) {
  const double frame[9] = {q.t1[0], q.t1[1], q.t1[2], q.t2[0], q.t2[1], q.t2[2], q.n[0], q.n[1], q.n[2]};
  for (std::size_t k = 0; k < w.padded; k += kSideBySide) {
    Lanes x, y, z;
    load(w.x, k, x);
    load(w.y, k, y);
    load(w.z, k, z);
    store((frame[0] * x + frame[1] * y) + frame[2] * z, k, w.u);
    store((frame[3] * x + frame[4] * y) + frame[5] * z, k, w.v);
    store((frame[6] * x + frame[7] * y) + frame[8] * z, k, w.h);
  }
}

RFSMOOTH_AVX2
void sum_up(const QuadricWorkspace& w, QuadricMoments<Lanes>& moments, QuadricHeights<Lanes>& heights) {
  QuadricMoments<Lanes> m;
  QuadricHeights<Lanes> h;
  for (std::size_t k = 0; k < w.padded; k += kSideBySide) {
    Lanes u, v, z, weight;
    load(w.u, k, u);
    load(w.v, k, v);
    load(w.h, k, z);
    load(w.weight, k, weight);
    m.add(u, v, weight);
    h.add(u, v, weight * z);
  }
  moments = m;
  heights = h;
}

/// Weighted least squares of z on the first `terms` monomials (3 = plane, 6 = quadric).
Vector6d fit(const QuadricWorkspace& w, int terms) {
  QuadricMoments<Lanes> moments;
  QuadricHeights<Lanes> heights;
  sum_up(w, moments, heights);
  Matrix6d a = moments.matrix(kTotal);
  Vector6d b = heights.vector(kTotal);
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

/// |z - height| of the samples.
RFSMOOTH_AVX2
void find_residuals(QuadricWorkspace& w, const Quadric& q) {
  const double c[6] = {q.c[0], q.c[1], q.c[2], q.c[3], q.c[4], q.c[5]};
  for (std::size_t k = 0; k < w.padded; k += kSideBySide) {
    Lanes u, v, z;
    load(w.u, k, u);
    load(w.v, k, v);
    load(w.h, k, z);
    const Lanes r = z - (c[0] + u * (c[1] + c[3] * u + c[4] * v) + v * (c[2] + c[5] * v));
    store(r < 0 ? -r : r, k, w.residual);
  }
}

RFSMOOTH_AVX2
void weigh_by_residual(QuadricWorkspace& w, double cut) {
  const double inverse = 1 / cut;
  for (std::size_t k = 0; k < w.padded; k += kSideBySide) {
    Lanes r, nearness;
    load(w.residual, k, r);
    load(w.nearness, k, nearness);
    r *= inverse;
    const Lanes inside = 1 - r * r, none = {};
    store(inside > 0 ? nearness * inside * inside : none, k, w.weight);
  }
}

/// The median of the residuals, finite. Of a histogram only the bin that it is in is searched: a selection
/// among all takes a branch at every one that cannot be foreseen.
double median_residual(QuadricWorkspace& w) {
  constexpr std::size_t kBins = 64;
  const auto begin = w.residual.begin(), end = begin + std::ptrdiff_t(w.count);
  const double bins = double(kBins) / *std::max_element(begin, end);
  w.sorted.assign(begin, end);
  if (!(bins > 0 && std::isfinite(bins))) return median(w.sorted);
  const auto bin_of = [bins](double r) { return std::size_t(r * bins); };
  std::array<std::size_t, kBins + 2> size = {};  // a product may be rounded up
  for (auto r = begin; r != end; ++r) ++size[bin_of(*r)];
  std::size_t bin = 0, nth = w.count / 2;
  while (nth >= size[bin]) nth -= size[bin++];
  std::size_t kept = 0;
  for (auto r = begin; r != end; ++r) {
    w.sorted[kept] = *r;
    kept += std::size_t(bin_of(*r) == bin);
  }
  const auto middle = w.sorted.begin() + std::ptrdiff_t(nth);
  std::nth_element(w.sorted.begin(), middle, w.sorted.begin() + std::ptrdiff_t(size[bin]));
  return *middle;
}

/// Tukey's biweight on top of the distance weights; returns false if the residuals leave nothing to do.
bool reweight(QuadricWorkspace& w, const Quadric& q) {
  if (!q.c.allFinite()) return false;
  find_residuals(w, q);
  constexpr double kOfMedian = 1.4826;  // sigma of a normal distribution over its median deviation
  constexpr double kExact = 1e-12;      // of the radius: the points lie on the quadric but for rounding
  const double cut = kTukey * kOfMedian * median_residual(w);
  if (!(cut > kExact)) return false;
  weigh_by_residual(w, cut);
  return true;
}

/// Root of the weighted mean square of the residuals, over the degrees of freedom that the weights leave a
/// fit of that many terms. In units of the radius.
double residual_deviation(QuadricWorkspace& w, const Quadric& q, int terms) {
  find_residuals(w, q);
  double sum = 0, total = 0, squares = 0;
  for (std::size_t j = 0; j < w.count; ++j) {
    const double weight = w.weight[j];
    sum += weight * (w.residual[j] * w.residual[j]);
    total += weight;
    squares += weight * weight;
  }
  if (!(squares > 0)) return 0;
  const double effective = total * total / squares;
  return std::sqrt(sum / total * effective / std::max(1.0, effective - terms));
}

/// Makes room for the centre and `count` neighbours.
void make_room(QuadricWorkspace& w, std::size_t count) {
  w.count = count + 1;
  w.padded = (w.count + kSideBySide - 1) / kSideBySide * kSideBySide;
  if (w.x.size() >= w.padded) return;
  for (auto* all : {&w.x, &w.y, &w.z, &w.u, &w.v, &w.h, &w.nearness, &w.weight, &w.residual})
    all->resize(2 * w.padded);
}

}  // namespace

Quadric fit_quadric(const Positions& points, const Vector3d& p, const Index* neighbours, std::size_t count,
                    QuadricWorkspace& w, int robust_rounds) {
  Quadric q;
  q.centre = p;
  make_room(w, count);
  double squared_reach = 0;
  w.x[0] = w.y[0] = w.z[0] = 0;
  for (std::size_t j = 0; j < count; ++j) {
    const Vector3d d = points[neighbours[j]] - p;
    w.x[j + 1] = d[0];
    w.y[j + 1] = d[1];
    w.z[j + 1] = d[2];
    squared_reach = std::max(squared_reach, d.squaredNorm());
  }
  for (auto* all : {&w.x, &w.y, &w.z})
    std::fill(all->begin() + std::ptrdiff_t(w.count), all->begin() + std::ptrdiff_t(w.padded), 0);
  if (!(squared_reach > 0)) return q;
  const double r = kBeyond * std::sqrt(squared_reach);
  Matrix3d covariance;
  weigh(w, r, covariance);
  const Matrix3d axes = symmetric_eigen_closed(covariance).vectors;
  q.n = axes.col(0);
  q.t1 = axes.col(2);
  q.t2 = q.n.cross(q.t1);
  if (count < 3) return q;

  turn_into(q, w);
  std::copy_n(w.nearness.begin(), w.padded, w.weight.begin());
  const int terms = count >= kFewestOfQuadric ? 6 : 3;
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

LocalSurface surface_at_centre(const Quadric& q) {
  LocalSurface surface{q.n, q.centre};
  if (q.radius == 0) return surface;
  surface.normal = q.normal(0, 0);
  surface.shadow = q.centre + (q.radius * q.c[0] * q.n.dot(surface.normal)) * surface.normal;
  surface.residual = q.residual;
  return surface;
}

}  // namespace rfsmooth::rfs_mesh
