/// From the EMST to the surface description graph (SDG): the tree "extended at appropriate regions"
/// (Vollmer et al. section 7, after Mencl). The tree stops at leaves and leaves wide gaps beside its
/// branches; the SDG continues the leaves and closes the gaps with edges that run along the surface, and
/// marks the tree edges that do not lie in it as bridges.
///
/// Differs from the paper: it gives the idea, not the rules. Ours, with every threshold in SdgOptions:
///
/// - (A) A leaf (degree 1) is joined to the nearest admissible point ahead of it.
/// - (B) A point whose neighbours leave a wide gap in the tangent plane is joined to the nearest admissible
///   point inside the gap, if the wish is mutual or the edge short; two rounds.
/// - (C) An edge far longer than the tree around both ends, or standing up from the surface at both, or with
///   an end between two sheets (two_sheets.h), is a bridge.
///
/// Each rule decides for every vertex from one snapshot of the graph, so no order of visiting matters.
#pragma once

#include <vector>

#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/local_surface.h"
#include "rfsmooth/rfs_mesh/mesh.h"
#include "rfsmooth/rfs_mesh/neighbors.h"
#include "rfsmooth/rfs_mesh/options.h"

namespace rfsmooth::rfs_mesh {

/// The thresholds of the rules, each with its reason.
struct SdgOptions {
  /// Longer edges jump over what lies between; an EMST edge is the shortest way, 2.5 of them span one missing
  /// neighbour on either side.
  double reach = 2.5;
  /// Two sheets that meet at a right angle stay apart; rounded edges and noisy normals do not.
  double normal_angle = 60;
  /// |n.(q - v)| / tangential length: an edge steeper than about 27 degrees leaves the surface.
  double steepness = 0.5;
  /// An edge is needless if some z is nearer to both ends than this share of it (1: relative neighbour
  /// graph).
  double lune = 0.85;
  /// The same for leaves, which have fewer choices.
  double leaf_lune = 0.70;
  double leaf_ahead = 75;      ///< a leaf looks this far to either side of straight on,
  double leaf_aside = 105;     ///< then this far,
  double leaf_clearance = 45;  ///< then anywhere at least this far from its one edge
  double gap_sparse = 150;     ///< a gap this wide is closed at vertices of degree 1 or 2,
  double gap = 120;            ///< this wide at vertices of higher degree (six neighbours would leave 60)
  double gap_clearance = 40;   ///< the new edge keeps this angle to both sides of the gap
  double lone_reach = 1.5;     ///< an edge only one end asks for may be this long
  double bridge = 4;           ///< an edge this many times longer than the tree around both ends is a bridge
  double bridge_steepness = 1.5;  ///< so is one standing this steeply on the surface at both ends

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"sdg-reach", "longest SDG edge", "x local EMST edge", 1, 100}, self.reach);
    visit(OptionInfo{"sdg-normal-angle", "largest angle between normals along an edge", "degrees", 0, 90},
          self.normal_angle);
    visit(OptionInfo{"sdg-steepness", "largest rise over run of an edge", "", 0, 100}, self.steepness);
    visit(OptionInfo{"sdg-lune", "an edge is dropped if a point is nearer to both ends than this share", "",
                     0, 1},
          self.lune);
    visit(OptionInfo{"sdg-leaf-lune", "the same for leaves", "", 0, 1}, self.leaf_lune);
    visit(OptionInfo{"sdg-leaf-ahead", "first cone in which a leaf looks ahead", "degrees", 0, 180},
          self.leaf_ahead);
    visit(OptionInfo{"sdg-leaf-aside", "second cone", "degrees", 0, 180}, self.leaf_aside);
    visit(OptionInfo{"sdg-leaf-clearance", "smallest angle to a leaf's one edge", "degrees", 0, 180},
          self.leaf_clearance);
    visit(OptionInfo{"sdg-gap-sparse", "gap closed at degree 1 and 2", "degrees", 0, 360}, self.gap_sparse);
    visit(OptionInfo{"sdg-gap", "gap closed at higher degree", "degrees", 0, 360}, self.gap);
    visit(OptionInfo{"sdg-gap-clearance", "smallest angle to the sides of the gap", "degrees", 0, 180},
          self.gap_clearance);
    visit(
        OptionInfo{"sdg-lone-reach", "longest edge that one end alone asks for", "x local EMST edge", 0, 100},
        self.lone_reach);
    visit(OptionInfo{"sdg-bridge", "length from which an edge is a bridge", "x local EMST edge", 1, 1e9},
          self.bridge);
    visit(OptionInfo{"sdg-bridge-steepness", "steepness from which an edge is a bridge", "", 0, 1e9},
          self.bridge_steepness);
  }
};

/// What the tests of the SDG and the RFS-mesh look at: positions (the points, their shadows, or smoothed
/// positions), the surface through each, the nearest neighbours among them, the noise that is left in them.
struct Terrain {
  const Positions& at;                        ///< n x 3
  const std::vector<LocalSurface>& surfaces;  ///< n; only the normals are read
  const NeighborTable& near;                  ///< n rows, nearest first
  double noise = 0;                           ///< standard deviation of `at` along the normal, world units
  const std::vector<char>& between;           ///< n flags (two_sheets.h), or none

  /// Whether v lies between two sheets and has no neighbours.
  bool is_between(Index v) const { return !between.empty() && between[v] != 0; }
};

/// The graph.
struct Sdg {
  std::vector<Edge> edges;           ///< tree and added edges, ascending; bridges are not among them
  Adjacency graph;                   ///< the same by vertex
  std::vector<Edge> bridges;         ///< tree edges by rule (C), ascending: edges + bridges is connected
  std::vector<double> local_length;  ///< n: median EMST edge length within two hops, measured in `at`
};

/// `tree` is the EMST (a < b in every edge), in any order. O(n k), parallel, the same for any number of
/// threads.
Sdg make_sdg(const Terrain& terrain, const std::vector<Edge>& tree, const SdgOptions& options,
             const Context& context);

}  // namespace rfsmooth::rfs_mesh
