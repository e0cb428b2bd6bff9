#include "rfs_mesh/noise/sites/views/sheets_around.h"

#include <algorithm>
#include <cmath>

#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/sites/views/fits_around.h"
#include "rfs_mesh/sheets/two_sheets.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Coefficients of a quadric.
constexpr double kOfQuadric = 6;

/// What each of two sheets shows by itself, of fits that hold both; world units.
double noise_of_sheet(const MomentsAround& around) {
  const double share = share_of_sheet(around.flatness, std::max(0.0, around.lean));
  // The quadric bends to the sheet that happens to have more points here and there, and so spreads what
  // lies between the sheets; by its share of the degrees of freedom.
  const double spread = (1 - share) * kOfQuadric / (around.freedom + kOfQuadric);
  const double least = kNarrowestWindow * kNarrowestWindow;
  return std::sqrt(around.variance() * std::max(least, share - spread));
}

/// Whether two sides are of one scan: beside points of one side are none of the other.
bool are_of_one_scan(const MomentsAround& around) {
  return around.beside < kLittle;
}

/// The square of how near two layers must be, which are then no sheets. \param apart NoiseModel::apart
double squared_nearest_of_layers(const MomentsAround& around, double lean, double apart) {
  const double radius = around.radius(), square = square_of_point(radius * radius, around.points);
  if (are_of_one_scan(around)) return around.alike_in_rows() ? 2 * square : square;
  return lean > 0 ? square : squared_nearest(square, apart);
}

/// Whether the fits show two layers that are nearer to each other than their points are, and no sheets.
/// \param apart NoiseModel::apart
bool are_layers(const MomentsAround& around, double apart) {
  if (!(around.flatness < kNormalFlatness)) return false;
  const double lean = std::max(0.0, around.lean), of_sheet = share_of_sheet(around.flatness, lean);
  if (!(of_sheet < share_of_sheet(kFlatnessOfSheets))) return false;
  return squared_gap(of_sheet, lean) * around.variance() < squared_nearest_of_layers(around, lean, apart);
}

/// Whether the scatter grows to the next wider balls, or to the widest, as only shape does.
bool grows_as_shape(const std::vector<MomentsAround>& seen, std::size_t k) {
  const std::size_t next = std::min(k + 1, seen.size() - 1);
  return next > 0 && seen[next].variance() > kGrowthOfNoise * kGrowthOfNoise * seen[next - 1].variance();
}

/// Those that are flattest of the ones that two sheets may have; as many as there are: none is.
std::size_t flattest_of(const std::vector<MomentsAround>& seen) {
  std::size_t flattest = seen.size();
  double flatness = kFlatnessOfSheets;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (!(seen[k].flatness < flatness) || grows_as_shape(seen, k)) continue;
    flattest = k;
    flatness = seen[k].flatness;
  }
  return flattest;
}

}  // namespace

SheetsAround look_for_sheets(const std::vector<Neighbor>& group, const std::vector<OpenFits>& open,
                             const NoiseStart& start, bool on_grid) {
  std::vector<MomentsAround> seen;
  for (const OpenFits& fits : open) seen.emplace_back(group, fits);
  const auto exceeds_rounding = [&](std::size_t k) {
    const double depths = on_grid ? 2 : 1;  // with no empty voxel between them there is one sheet
    return !are_two_depths(seen[k].variance(), depths * open[k].rounding_around(group));
  };
  SheetsAround found;
  const std::size_t flattest = flattest_of(seen);
  const bool two = flattest < seen.size();
  if (two && exceeds_rounding(flattest)) {
    found.sheet = noise_of_sheet(seen[flattest]);
    found.middle = seen[flattest].middle;
  }
  if (start.on_lines) return found;
  const std::size_t k = two && seen[flattest].lean <= 0 ? flattest : 0;
  if (!are_layers(seen[k], start.apart) || !exceeds_rounding(k)) return found;
  found.sheet = SiteView::kNone;
  found.layers = std::sqrt(seen[0].variance());
  return found;
}

}  // namespace rfsmooth::rfs_mesh
