#include "rfs_mesh/noise/scatter_statistics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rfs_mesh/chi_square.h"
#include "rfs_mesh/noise/noise_levels.h"

namespace rfsmooth::rfs_mesh {

namespace {

double chi_square(double freedom, double deviate) {
  return std::pow(root_of_chi_square(freedom, deviate), 3);
}

/// How much balls of these squared radii count.
std::vector<double> areas_of_squares(std::vector<double> squares) {
  const double typical = size_where_sparse(squares);
  for (double& a : squares) a = typical > 0 ? std::min(1.0, a / typical) : 1;
  return squares;
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

double size_where_sparse(std::vector<double> sizes) {
  constexpr double kTypicalArea = 0.75;
  return quantile(sizes, kTypicalArea);
}

std::vector<double> areas(const std::vector<Scatter>& all) {
  std::vector<double> radii;
  for (const Scatter& s : all) radii.push_back(s.radius);
  return areas(radii);
}

std::vector<double> areas(const std::vector<double>& radii) {
  std::vector<double> squares;
  for (const double r : radii) squares.push_back(r * r);
  return areas_of_squares(std::move(squares));
}

std::vector<Weighed> comparable(const std::vector<Scatter>& all, const std::vector<double>& area,
                                double deviate) {
  std::vector<Weighed> variances;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (says(all[i])) variances.push_back({all[i].variance / chi_square(all[i].freedom, deviate), area[i]});
  return variances;
}

std::vector<Said> what_they_say(const std::vector<Scatter>& all, double deviate) {
  std::vector<Said> said;
  said.reserve(all.size());
  for (const Scatter& s : all)
    said.push_back({s.radius * s.radius, s.variance, s.freedom,
                    says(s) ? s.variance / chi_square(s.freedom, deviate) : 0});
  return said;
}

double mean_variance(const std::vector<Said>& all, double share) {
  std::vector<double> squares(all.size());
  std::transform(all.begin(), all.end(), squares.begin(), [](const Said& s) { return s.square; });
  const std::vector<double> area = areas_of_squares(std::move(squares));
  std::vector<Weighed> variances;
  variances.reserve(all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    if (says(all[i])) variances.push_back({all[i].comparable, area[i]});
  if (variances.empty()) return 0;
  const double typical = quantile(variances, share);
  double sum = 0, weights = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Said& s = all[i];
    if (!says(s) || s.variance > kLouder * kLouder * typical) continue;
    sum += area[i] * s.freedom * s.variance;
    weights += area[i] * s.freedom;
  }
  return weights > 0 ? sum / weights : typical;
}

double mean_variance(const std::vector<Scatter>& all, double share, double deviate) {
  return mean_variance(what_they_say(all, deviate), share);
}

}  // namespace rfsmooth::rfs_mesh
