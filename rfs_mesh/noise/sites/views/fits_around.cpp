#include "rfs_mesh/noise/sites/views/fits_around.h"

#include <algorithm>
#include <cmath>

#include "base/quantile.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/sheets/two_sheets.h"

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

MomentsAround::MomentsAround(const std::vector<Neighbor>& group, const OpenFits& open)
    : said(around(group, open.said, kNeighbourhood)), points(open.points) {
  // Of two dozen normal values, unweighted. Wide fits lean less by chance, but so they do by sheets that the
  // quadric has bent to: with 6 / points there, too, plates would be taken for layers.
  constexpr double kLeanByChance = 6 / double(kNeighbourhood);
  double saying = 0;
  for (std::size_t k = 0; k < said.size(); ++k) {
    const Scatter& fit = open.all[group[k].index];
    if (!says(fit)) continue;
    freedom += fit.freedom;
    flatness += fit.flatness;
    lean += fit.lean - kLeanByChance;
    middle += fit.middle;
    beside += fit.beside;
    in_row += fit.in_row;
    ++saying;
  }
  for (double* const sum : {&freedom, &flatness, &lean, &middle, &beside, &in_row}) *sum /= saying;
}

bool MomentsAround::normal() const {
  return middle > kNormalMiddle / kSameNoise && middle < kNormalMiddle * kSameNoise &&
         flatness > kFlatnessOfSheets && flatness < 2 * kNormalFlatness - kFlatnessOfSheets;
}

double MomentsAround::radius() const {
  return std::sqrt(quantile_of(said, 0.5, &Said::square));
}

}  // namespace rfsmooth::rfs_mesh
