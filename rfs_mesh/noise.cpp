#include "rfsmooth/rfs_mesh/noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the development shapes with noise of 0.1 to 3 spacings (tests/bench/quality).
constexpr std::size_t kSamples = 4000, kSearch = 1000;  // fits for the field, and while looking for m
constexpr std::size_t kNarrowest = 24, kWidest = 1536;
constexpr double kShareOfRadius = 0.18;
constexpr double kGrowthOfNoise = 1.26;  // cube root of 2: a ball inside a slab; faster growth is shape
constexpr double kDeviate = -0.84;       // the lower 20 %: the flat places
constexpr double kQuantile = 0.2;
constexpr int kAround = 32;  // fits whose quantile is the noise near a point
constexpr int kBlend = 4;    // fits that a point between them takes the mean of

/// What one fit says.
struct Scatter {
  double deviation = 0, radius = 0, freedom = 1;
};

/// The quantile of the root of a chi-square variable over its degrees of freedom (Wilson & Hilferty).
double quantile_of_deviation(double freedom) {
  const double v = 2 / (9 * freedom);
  return std::pow(std::max(0.1, 1 - v + kDeviate * std::sqrt(v)), 1.5);
}

Scatter scatter(const Positions& points, const std::vector<Neighbor>& near) {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  Scatter s;
  s.radius = std::sqrt(near.back().squared_distance);
  if (!(s.radius > 0)) return s;
  const double r = 1.1 * s.radius;  // the farthest neighbour keeps a little weight
  const Eigen::Vector3d& p = points[near.front().index];
  const auto weigh = [&](const Eigen::Vector3d& d) {
    const double inside = 1 - d.squaredNorm();
    return inside * inside;
  };
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double weights = 0;
  for (const Neighbor& q : near) {
    const Eigen::Vector3d d = (points[q.index] - p) / r;
    const double w = weigh(d);
    sum += w * d;
    spread += w * d * d.transpose();
    weights += w;
  }
  spread -= sum * sum.transpose() / weights;
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  const auto features = [&](const Eigen::Vector3d& d) {
    const double u = axes.col(2).dot(d), v = axes.col(1).dot(d);
    return (Vector6() << 1, u, v, u * u, u * v, v * v).finished();
  };
  Matrix6 a = Matrix6::Zero(), b = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  double squares = 0, heights = 0;
  for (const Neighbor& q : near) {
    const Eigen::Vector3d d = (points[q.index] - p) / r;
    const double w = weigh(d), z = axes.col(0).dot(d);
    const Vector6 f = features(d);
    a.selfadjointView<Eigen::Lower>().rankUpdate(f, w);
    b.selfadjointView<Eigen::Lower>().rankUpdate(f, w * w);
    right += w * z * f;
    heights += w * z * z;
    squares += w * w;
  }
  a.diagonal().array() += 1e-9 * weights;
  const Eigen::LLT<Matrix6> solver(a.selfadjointView<Eigen::Lower>());
  const Matrix6 full = b.selfadjointView<Eigen::Lower>();
  const double left = weights - solver.solve(full).trace();
  const double residual = heights - right.dot(solver.solve(right));
  if (!(left > 0) || !std::isfinite(residual)) return s;
  s.deviation = r * std::sqrt(std::max(0.0, residual) / left);
  s.freedom = std::max(1.0, left * left / squares);
  return s;
}

/// Fits at `count` points spread over the indices.
std::vector<Scatter> fits(const SpatialIndex& index, std::size_t count, std::size_t m,
                          const Context& context) {
  std::vector<Scatter> all(count);
  for_blocks(context, count, 16, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near;
    for (std::size_t s = begin; s < end; ++s) {
      index.nearest(index.points()[s * index.points().size() / count], int(m + 1), near);
      all[s] = scatter(index.points(), near);
    }
  });
  return all;
}

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The low quantile of the deviations, each in units of what that quantile is for pure noise.
double flat_places(const std::vector<Scatter>& all) {
  std::vector<double> deviations;
  deviations.reserve(all.size());
  for (const Scatter& s : all) deviations.push_back(s.deviation / quantile_of_deviation(s.freedom));
  return quantile(deviations, kQuantile);
}

/// The field from the fits: a quantile over each fit's neighbours, then the mean of those nearest to a point.
std::vector<double> spread_out(const SpatialIndex& index, const std::vector<Scatter>& all,
                               const Context& context) {
  const std::size_t n = index.points().size(), count = all.size();
  Positions at(count);
  for (std::size_t s = 0; s < count; ++s) at[s] = index.points()[s * n / count];
  const SpatialIndex fitted(at, context);
  std::vector<double> calm(count), local(n);
  for_blocks(context, count, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near;
    std::vector<Scatter> around;
    for (std::size_t s = begin; s < end; ++s) {
      fitted.nearest(at[s], kAround, near);
      around.clear();
      for (const Neighbor& q : near) around.push_back(all[q.index]);
      calm[s] = flat_places(around);
    }
  });
  for_blocks(context, n, 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near;
    for (std::size_t i = begin; i < end; ++i) {
      fitted.nearest(index.points()[i], kBlend, near);
      double sum = 0;
      for (const Neighbor& q : near) sum += calm[q.index];
      local[i] = sum / double(near.size());
    }
  });
  return local;
}

}  // namespace

NoiseField measure_noise(const SpatialIndex& index, const Context& context) {
  const std::size_t n = index.points().size();
  NoiseField noise;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t m = kNarrowest; m <= kWidest && m < n; m *= 2) {
    const std::vector<Scatter> all = fits(index, std::min(n, kSearch), m, context);
    const double sigma = flat_places(all);
    if (noise.neighbours > 0 && sigma > kGrowthOfNoise * noise.sigma) break;
    std::vector<double> radii;
    radii.reserve(all.size());
    for (const Scatter& s : all) radii.push_back(s.radius);
    const double radius = quantile(radii, 0.5), share = radius > 0 ? sigma / radius : 0;
    if (share < least) {
      least = share;
      noise.sigma = sigma;
      noise.neighbours = m;
    }
    if (share <= kShareOfRadius) break;
  }
  noise.local.assign(n, noise.sigma);
  if (noise.neighbours > 0)
    noise.local = spread_out(index, fits(index, std::min(n, kSamples), noise.neighbours, context), context);
  return noise;
}

}  // namespace rfsmooth::rfs_mesh
