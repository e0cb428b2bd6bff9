/// Which of two near sheets (of a thin plate, a fold) a noisy point belongs to.
///
/// A shadow (local_surface.h) follows the sheet nearest to its point. That fails for points that noise has
/// carried near the middle: quadrics of both sheets claim them, their shadows end in between, and edges from
/// there join the two sides. For such a point we look at the shadows around it, which lie in two sheets.
/// Along the common axis a of their normals the heights
///
///     h_j = a . (shadow_j - p)
///
/// are split into two sheets, with the least variance inside (two_sheets.h). If the sheets are well apart,
/// parallel, and both extend around the point's foot, then
/// - a point clearly nearer to one of them takes its shadow and normal from that one;
/// - a point about as far from both is *between*: nothing tells which sheet it came from, and any neighbours
///   would be wrong half of the time. It gets none, and its tree edges are bridges (sdg.h).
///
/// With two sheets six standard deviations apart 0.8 % of the points are between, and 0.05 % of the edges
/// still cross. A single sheet is left as it is.
///
/// Paper: none. Vollmer et al. (section 7) have no noise that reaches the next sheet. Thread safe: no state
/// is kept.
#pragma once

#include <vector>

#include <rfsmooth/connect.h>

#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Corrects the shadows and normals of `surfaces` (n) that lie between two sheets, and returns which points
/// are between: n flags, or none if no point is. `shadows`: an index over shadows of the n points (those of
/// `surfaces`, or of an earlier fit; only neighbourhoods are taken from it); `near`: its table; `sigma`:
/// noise of the points, world units. O(n k), and a search for each of the few doubtful points. Parallel,
/// deterministic.
std::vector<char> part_sheets(const Positions& points, const SpatialIndex& shadows, const NeighborTable& near,
                              double sigma, const SheetsOptions& options, std::vector<LocalSurface>& surfaces,
                              const Context& context);

}  // namespace rfsmooth::rfs_mesh
