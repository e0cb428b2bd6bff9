#include "rfs_mesh/noise/scatter_statistics.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

double chi_square(double freedom, double deviate) {
  const double v = 2 / (9 * freedom);
  return std::pow(std::max(0.1, 1 - v + deviate * std::sqrt(v)), 3);
}

}  // namespace

double quantile(std::vector<Weighed>& values, double share) {
  std::sort(values.begin(), values.end(),
            [](const Weighed& a, const Weighed& b) { return a.value < b.value; });
  double all = 0, below = 0;
  for (const Weighed& v : values) all += v.weight;
  for (const Weighed& v : values)
    if ((below += v.weight) >= share * all) return v.value;
  return values.back().value;
}

std::vector<double> areas(const std::vector<Scatter>& all) {
  std::vector<double> radii;
  for (const Scatter& s : all) radii.push_back(s.radius);
  return areas(radii);
}

std::vector<double> areas(const std::vector<double>& radii) {
  constexpr double kTypicalArea = 0.75;
  std::vector<double> area;
  for (const double r : radii) area.push_back(r * r);
  std::vector<double> sorted = area;
  const double typical = quantile(sorted, kTypicalArea);
  for (double& a : area) a = typical > 0 ? std::min(1.0, a / typical) : 1;
  return area;
}

std::vector<Weighed> comparable(const std::vector<Scatter>& all, const std::vector<double>& area,
                                double deviate) {
  std::vector<Weighed> variances;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (says(all[i])) variances.push_back({all[i].variance / chi_square(all[i].freedom, deviate), area[i]});
  return variances;
}

double mean_variance(const std::vector<Scatter>& all, double share, double deviate) {
  const std::vector<double> area = areas(all);
  std::vector<Weighed> variances = comparable(all, area, deviate);
  if (variances.empty()) return 0;
  const double typical = quantile(variances, share);
  double sum = 0, weights = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Scatter& s = all[i];
    if (!says(s) || s.variance > kLouder * kLouder * typical) continue;
    sum += area[i] * s.freedom * s.variance;
    weights += area[i] * s.freedom;
  }
  return weights > 0 ? sum / weights : typical;
}

Positions pick(const Positions& points, std::size_t count) {
  Positions picked(count);
  for (std::size_t s = 0; s < count; ++s) picked[s] = points[s * points.size() / count];
  return picked;
}

std::vector<Scatter> fits(const SpatialIndex& index, const Positions& places, std::size_t m,
                          const std::vector<double>& sigma, const Context& context,
                          std::vector<KeptNeighbors>* kept) {
  return fits(index, places, std::vector<std::size_t>(places.size(), m), sigma, context, kept);
}

std::vector<Scatter> fits(const SpatialIndex& index, const Positions& places,
                          const std::vector<std::size_t>& m, const std::vector<double>& sigma,
                          const Context& context, std::vector<KeptNeighbors>* kept) {
  std::vector<Scatter> all(places.size());
  for_blocks(context, places.size(), 16, [&](std::size_t begin, std::size_t end) {
    ScatterFit fit;
    for (std::size_t s = begin; s < end; ++s)
      all[s] = fit(index, places[s], m[s], sigma[s], kept != nullptr ? &(*kept)[s] : nullptr);
  });
  return all;
}

}  // namespace rfsmooth::rfs_mesh
