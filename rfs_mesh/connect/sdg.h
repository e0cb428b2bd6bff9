/// From the EMST to the surface description graph (SDG): the tree "extended at appropriate regions" (Vollmer
/// et al. section 7, after Mencl). The tree stops at leaves and leaves wide gaps beside its branches. The SDG
/// continues the leaves, closes the gaps with edges along the surface, and marks as bridges the tree edges
/// that do not lie in it.
///
/// Differs from the paper: it gives the idea but no rules. Ours, with every threshold in SdgOptions:
///
/// - (A) A leaf (degree 1) is joined to the nearest admissible point ahead of it.
/// - (B) A point whose neighbours leave a wide gap in the tangent plane is joined to the nearest admissible
///   point inside the gap, if that point wants the same edge or the edge is short; two rounds.
/// - (C) A tree edge is a bridge if it is far longer than the tree around both ends, or stands up from the
///   surface at both, or has an end between two sheets (part_sheets.h).
///
/// Each rule decides for every vertex on one snapshot of the graph, so the order of visiting does not matter.
/// Thread safe: no state is kept.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <rfsmooth/connect.h>

#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// What the SDG and the RFS-mesh are built from: positions (the points or their shadows), the surface at
/// each, the nearest neighbours among them, and the noise that is left in them.
struct Terrain {
  const Positions& at;                        ///< n x 3
  const std::vector<LocalSurface>& surfaces;  ///< n; only the normals are read
  const NeighborTable& near;                  ///< n rows, nearest first
  double noise = 0;                           ///< standard deviation of `at` along the normal, world units
  const std::vector<char>& between;           ///< n flags (part_sheets.h), or none

  /// Whether v lies between two sheets; it gets no neighbours then.
  bool is_between(Index v) const { return !between.empty() && between[v] != 0; }

  /// Whether d rises more than `most` over its run along the surface at v, beyond what noise explains.
  bool is_steep(Index v, const Eigen::Vector3d& d, double most) const {
    const double rise = std::abs(surfaces[v].normal.dot(d)), over = rise - noise;
    const double squared_run = std::max(0.0, d.squaredNorm() - rise * rise);
    return over > 0 && over * over > most * most * squared_run;
  }
  /// Whether v and q may be neighbours along the surface: d = q - v is not steep at either, and the cosine of
  /// their normals' angle, whatever their sides, is at least `cosine`.
  bool is_along(Index v, Index q, const Eigen::Vector3d& d, double cosine, double most) const {
    return std::abs(surfaces[v].normal.dot(surfaces[q].normal)) >= cosine && !is_steep(v, d, most) &&
           !is_steep(q, d, most);
  }
};

/// The graph.
struct Sdg {
  std::vector<Edge> edges;           ///< tree and added edges, ascending; bridges are not among them
  Adjacency graph;                   ///< the same by vertex
  std::vector<Edge> bridges;         ///< tree edges by rule (C), ascending: edges + bridges is connected
  std::vector<double> local_length;  ///< n: median EMST edge length within two hops, measured in `at`
};

/// The SDG. `tree`: the EMST (a < b in every edge), in any order. O(n k), parallel, the same for any number
/// of threads.
Sdg make_sdg(const Terrain& terrain, const std::vector<Edge>& tree, const SdgOptions& options,
             const Context& context);

}  // namespace rfsmooth::rfs_mesh
