/// Where two sheets are near each other (a thin plate, a fold): which of them a noisy point belongs to.
///
/// A shadow (local_surface.h) follows the sheet its point lies nearest to. That fails for the points noise
/// has carried near the middle: quadrics of both sheets claim them, their shadows end in between, and edges
/// from there join the two sides. Here such a point looks at the shadows around it, which lie in two sheets:
/// along the common axis a of their normals the heights
///     h_j = a . (shadow_j - p)
/// split into two groups (the split of least variance within). If the sheets are well apart, parallel and
/// both on either side of the point's foot, then
///  - a point well nearer to one of them has its shadow and normal from that one;
///  - a point about as far from both is *between*: nothing tells which sheet it came from, and any
///    neighbours would be the wrong ones half of the time. It has none: its tree edges are bridges (sdg.h).
/// Two sheets six standard deviations apart lose 0.8 % of their points so and keep 0.05 % of edges that
/// cross; a single sheet has no second sheet, and nothing changes on it.
///
/// Paper: none; Vollmer et al. (section 7) have no noise that reaches the next sheet.
/// Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/connect.h>

#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Corrects the shadows and normals of `surfaces` (n) that lie between two sheets, and says which points are
/// between: n flags, or none if no point is. `shadows` is an index over shadows of the n points (those of
/// `surfaces`, or of an earlier fit: only who is near whom is taken from it), `near` its table; `sigma`:
/// noise of the points, world units. O(n k), a search only for the few points in doubt. Parallel,
/// deterministic.
std::vector<char> part_sheets(const Positions& points, const SpatialIndex& shadows, const NeighborTable& near,
                              double sigma, const SheetsOptions& options, std::vector<LocalSurface>& surfaces,
                              const Context& context);

}  // namespace rfsmooth::rfs_mesh
