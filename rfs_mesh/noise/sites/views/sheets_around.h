/// Two sheets, or layers, that the fits without windows around a site show. Where both are within a ball, the
/// residuals are flatter than a normal distribution, and their moments tell how far they are apart
/// (share_of_sheet, two_sheets.h).
///
/// Two sheets: the fourth moment tells the variance of one. A ball narrower than the sheets are apart holds
/// hardly any of the second one, a wide one bends away with the surface: those count that are flattest, but
/// not if
///
/// - their scatter grows to the next wider ball (or to the widest) as only shape does,
/// - or the residuals are as small as those of two depths in steps that follow each other, which look like
///   two sheets; on a grid, as those of two with one between them: voxels are filled evenly.
///
/// Layers: two scans that do not quite meet leave two. Where more points are on one, the residuals lean, too,
/// and both moments together tell how far apart the layers are. Nearer to each other than the points are to
/// their neighbours (a square of the cloud's spacing has one point) they cannot both be surfaces, and what is
/// seen is the noise. Layers with as many points each may be the sides of a plate: these must be nearer than
/// a point is to its nearest neighbour: half a side of that square where points lie at random, all of it
/// where the cloud was thinned so that they keep a distance (NoiseModel::apart). Lines have no such square.
///
/// Nor are the two sides of one scan sheets, whose rows or points lie to one side and the other in turns: two
/// laser heads, a mirror that swings both ways. Beside a point of one sheet some of the other lie, since each
/// is scanned by itself; beside one of such a scan, none does (Scatter::beside). These are layers where they
/// are nearer to each other than their points are; where whole rows lie to a side, nearer than the points of
/// one side are, which have a square twice as large.
#pragma once

#include <optional>
#include <vector>

#include "rfs_mesh/noise/noise_search.h"
#include "rfs_mesh/noise/sites/views/open_fits.h"

namespace rfsmooth::rfs_mesh {

/// What is seen around a site; world units.
struct SheetsAround {
  double sheet = SiteView::kNone;  ///< what each of two sheets shows; kNone: there is one
  double middle = 1;               ///< Scatter::middle of both
  std::optional<double> layers;    ///< the noise, if there are layers; then there are no sheets
};

/// \param open from kNeighbourhood points on, each of twice as many. \param on_grid whether points are on a
/// grid in space
SheetsAround look_for_sheets(const std::vector<Neighbor>& group, const std::vector<OpenFits>& open,
                             const NoiseStart& start, bool on_grid);

}  // namespace rfsmooth::rfs_mesh
