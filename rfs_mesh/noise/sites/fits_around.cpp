#include "rfs_mesh/noise/sites/fits_around.h"

#include <algorithm>
#include <cmath>

#include "base/quantile.h"
#include "rfs_mesh/noise/noise_levels.h"

namespace rfsmooth::rfs_mesh {

FitsAround::FitsAround(const std::vector<Neighbor>& group, const OpenFits& open)
    : points(double(open.points)) {
  std::vector<const Scatter*> saying;
  std::vector<double> variance, radii;
  for (const Neighbor& q : group) {
    const Scatter& fit = open.all[q.index];
    if (!says(fit)) continue;
    saying.push_back(&fit);
    variance.push_back(fit.variance);
    radii.push_back(fit.radius);
  }
  if (saying.empty()) return;
  scatter = std::sqrt(quantile(variance, kTypical));
  radius = median(radii);
  const double loud = kLouder * kLouder * scatter * scatter;
  saying.erase(
      std::remove_if(saying.begin(), saying.end(), [&](const Scatter* fit) { return fit->variance > loud; }),
      saying.end());
  signs = signs_of(saying);
}

}  // namespace rfsmooth::rfs_mesh
