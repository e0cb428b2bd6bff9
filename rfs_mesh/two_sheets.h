/// Where two sheets are near each other (a thin plate, a fold): which of them a noisy point belongs to.
///
/// A shadow (local_surface.h) follows the sheet its point lies nearest to. That fails for the points noise
/// has carried near the middle: quadrics of both sheets claim them, their shadows end in between, and edges
/// from there join the two sides. Here such a point looks at the shadows around it, which lie in two layers:
/// along the common axis a of their normals the heights
///     h_j = a . (shadow_j - p)
/// split into two groups (the split of least variance within). If the layers are well apart, parallel and
/// both on either side of the point's foot, then
///  - a point well nearer to one of them has its shadow and normal from that one;
///  - a point about as far from both is *between*: nothing tells which sheet it came from, and any
///    neighbours would be the wrong ones half of the time. It has none: its tree edges are bridges (sdg.h).
/// Two sheets six standard deviations apart lose 0.8 % of their points so and keep 0.05 % of edges that
/// cross; a single sheet has no second layer, and nothing changes on it.
///
/// Paper: none; Vollmer et al. (section 7) have no noise that reaches the next sheet.
#pragma once

#include <vector>

#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/local_surface.h"
#include "rfsmooth/rfs_mesh/neighbors.h"
#include "rfsmooth/rfs_mesh/options.h"

namespace rfsmooth::rfs_mesh {

/// The thresholds, each with its reason.
struct SheetsOptions {
  int looked_at = 48;  ///< shadows around a point: in each of two layers as many as a neighbourhood has
  /// Gap over scatter within the layers. A Gaussian cut in two at its middle has 2.2, an even slab 3.5.
  double apart = 5;
  /// Mean squared cosine between the normals and their axis: 27 degrees. Faces that meet at an edge have
  /// less.
  double parallel = 0.8;
  /// A layer's centre lies at most this share of its extent beside the point's foot; beyond, the point looks
  /// at two surfaces side by side, as at a step.
  double beside = 0.5;
  /// Noise from which a point's distance to its sheet is worth a doubt; layers are at least twice that apart.
  double far = 1.5;
  /// A point at least this share of the gap from the nearer layer is between. At six standard deviations the
  /// odds for the farther one are there 1 : 37; what is missed is then a sixth of what crosses the middle.
  double between = 0.4;
  /// A shadow this far off its layer is put onto it: twice what the quadrics' own scatter explains.
  double off = 0.8;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"sheets-looked-at", "shadows among which two layers are looked for", "points", 16, 1000},
          self.looked_at);
    visit(OptionInfo{"sheets-apart", "gap from which there are two layers", "x scatter within them", 1, 1e9},
          self.apart);
    visit(OptionInfo{"sheets-parallel", "mean squared cosine from which normals are parallel", "", 0, 1},
          self.parallel);
    visit(OptionInfo{"sheets-beside", "farthest that a layer's centre lies beside the point", "x extent", 0,
                     100},
          self.beside);
    visit(OptionInfo{"sheets-far", "distance from its sheet at which a point is doubted", "x noise", 0, 1e9},
          self.far);
    visit(OptionInfo{"sheets-between", "nearer the middle than this a point has no neighbours", "x gap", 0,
                     0.5},
          self.between);
    visit(OptionInfo{"sheets-off", "a shadow farther from its layer is put onto it", "x noise", 0, 1e9},
          self.off);
  }
};

/// Corrects the shadows and normals of `surfaces` (n) that lie between two layers, and says which points are
/// between: n flags, or none if no point is. `shadows` is an index over shadows of the n points (those of
/// `surfaces`, or of an earlier fit: only who is near whom is taken from it), `near` its table; `sigma`:
/// noise of the points, world units. O(n k), a search only for the few points in doubt. Parallel,
/// deterministic.
std::vector<char> part_sheets(const Positions& points, const SpatialIndex& shadows, const NeighborTable& near,
                              double sigma, const SheetsOptions& options, std::vector<LocalSurface>& surfaces,
                              const Context& context);

}  // namespace rfsmooth::rfs_mesh
