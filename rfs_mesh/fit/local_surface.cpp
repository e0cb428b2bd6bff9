#include "rfs_mesh/fit/local_surface.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/chi_square.h"
#include "rfs_mesh/fit/flattest_slab.h"
#include "rfs_mesh/fit/quadric.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

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

}  // namespace

std::vector<LocalSurface> local_surfaces(const Positions& points, const NeighborTable& near,
                                         const Context& context) {
  std::vector<LocalSurface> surfaces(points.size());
  for_blocks(context, points.size(), 1024, [&](std::size_t begin, std::size_t end) {
    QuadricWorkspace workspace;
    for (std::size_t i = begin; i < end; ++i) {
      const auto row = near[i];
      surfaces[i] = surface_at_centre(fit_quadric(points, points[i], row.begin(), row.size(), workspace));
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

std::vector<double> nearest_distances(const SpatialIndex& index, const Context& context) {
  if (index.points().size() < 2) return {};
  const std::vector<Index> rows = sample_rows(index.points().size());
  const std::size_t count = rows.size();
  std::vector<double> nearest(count);
  for_blocks(context, count, 256, [&](std::size_t begin, std::size_t end) {
    NearestOthers others;
    for (std::size_t s = begin; s < end; ++s) {
      const Index i = rows[s];
      nearest[s] = (index.points()[others.find(index, i, 1).front()] - index.points()[i]).norm();
    }
  });
  return nearest;
}

double mean_spacing(const std::vector<double>& nearest, const Context& context) {
  if (nearest.empty()) return 0;
  return sum_over(context, nearest.size(), 0.0, [&](std::size_t s) { return nearest[s]; }) /
         double(nearest.size());
}

namespace {

/// The lower quartile of the square root of a chi-square variable over its degrees of freedom.
double quartile_of_deviation(double freedom) {
  return std::pow(root_of_chi_square(freedom, -0.6745), 1.5);
}

/// The flat places' residual and the median radius of neighbourhoods of m.
NoiseScale seen_at(const SpatialIndex& index, std::size_t m, const Context& context) {
  constexpr double kEffective = 5.0 / 9;  // (mean w)^2 / mean w^2 of w = (1 - t^2)^2 over a disk
  const Positions& points = index.points();
  const std::vector<Index> rows = sample_rows(points.size(), kPlacesOfCloud);
  const std::size_t samples = rows.size();
  std::vector<double> residuals(samples), radii(samples);
  for_blocks(context, samples, 16, [&](std::size_t begin, std::size_t end) {
    QuadricWorkspace workspace;
    NearestOthers nearest;
    for (std::size_t s = begin; s < end; ++s) {
      const Index i = rows[s];
      const auto& row = nearest.find(index, i, m);
      residuals[s] = fit_quadric(points, points[i], row.data(), row.size(), workspace, 0).residual;
      radii[s] = row.empty() ? 0 : (points[row.back()] - points[i]).norm();
    }
  });
  const auto quartile = residuals.begin() + std::ptrdiff_t(samples / 4);
  std::nth_element(residuals.begin(), quartile, residuals.end());
  return {*quartile / quartile_of_deviation(std::max(1.0, kEffective * double(m + 1) - 6)), m, median(radii)};
}

}  // namespace

NoiseScale noise_scale(const SpatialIndex& index, const Context& context, double measured, double louder,
                       bool understated) {
  constexpr std::size_t kUsual = 384;  // radius of eleven spacings; wider ones blur detail
  const double known = understated ? measured : 0;
  double shown = 0;
  return flattest_slab(kNeighbourhood, index.points().size(), [&](std::size_t m) {
    if (m > kUsual && kGrowthOfNoise * shown >= measured) return NoiseScale();
    NoiseScale seen = seen_at(index, m, context);
    seen.sigma = shown = std::max(known, louder * seen.sigma);
    return seen;
  });
}

Positions shadows(const std::vector<LocalSurface>& surfaces, const Context& context) {
  Positions at(surfaces.size());
  for_each_index(context, at.size(), [&](std::size_t i) { at[i] = surfaces[i].shadow; });
  return at;
}

}  // namespace rfsmooth::rfs_mesh
