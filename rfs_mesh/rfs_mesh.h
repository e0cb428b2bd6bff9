/// The room's front door: from points to the RFS-mesh ("replacement for surface"), the rough mesh on which
/// the noise is smoothed away (Vollmer et al. section 7):
///
///   points -> neighbours, local surfaces, noise -> EMST -> SDG -> umbrellas -> faces -> RFS-mesh
///
/// "The only requirement is that the neighbourhoods on the reconstructed mesh are about the same as they are
/// on the underlying real surface": faces may cross and overlap, there may be holes; the mesh is not manifold
/// and is not meant to be. At most two faces meet at an edge, and no edge is without a face, except the SDG
/// edges of vertices that no face reaches (`Mesh::loose_edges`).
///
/// Differs from the paper: connectivity is tested on the shadow of the cloud (local_surface.h) where noise
/// exceeds a share of the spacing, or on positions the caller gives; points that noise carried between two
/// near sheets have no neighbours (two_sheets.h); thresholds are ours (SheetsOptions, SdgOptions,
/// UmbrellaOptions).
#pragma once

#include <string>
#include <vector>

#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/local_surface.h"
#include "rfsmooth/rfs_mesh/mesh.h"
#include "rfsmooth/rfs_mesh/neighbors.h"
#include "rfsmooth/rfs_mesh/options.h"
#include "rfsmooth/rfs_mesh/sdg.h"
#include "rfsmooth/rfs_mesh/stage_times.h"
#include "rfsmooth/rfs_mesh/two_sheets.h"
#include "rfsmooth/rfs_mesh/umbrella.h"

namespace rfsmooth::rfs_mesh {

/// How to connect.
struct ConnectOptions {
  int neighbours = 24;       ///< nearest neighbours looked at; about two and a half rings of a surface mesh
  double shadow_from = 0.3;  ///< noise / spacing from which tests are made on the shadow
  SheetsOptions sheets;
  SdgOptions sdg;
  UmbrellaOptions umbrella;
  /// Whether Connection::emst is wanted where the tests are made on the shadow, on a tree of its own.
  bool tree_of_points = true;
  /// Whether vertices that no face reaches keep their SDG edges (Mesh::loose_edges) and are neighbours by
  /// them.
  bool loose_edges = true;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"connect-neighbours", "nearest neighbours looked at", "points", 6, 200},
          self.neighbours);
    visit(OptionInfo{"connect-shadow-from", "noise from which connectivity is tested on the shadow",
                     "x spacing", 0, 1e9},
          self.shadow_from);
    SheetsOptions::describe(self.sheets, visit);
    SdgOptions::describe(self.sdg, visit);
    UmbrellaOptions::describe(self.umbrella, visit);
  }
};

/// Everything the stages made. All of it refers to the points by index.
struct Connection {
  Mesh mesh;                           ///< the RFS-mesh over the points as given
  std::vector<Edge> emst;              ///< n - 1, ascending by length; empty if not wanted and not needed
  std::vector<Edge> sdg;               ///< ascending; without the bridges
  std::vector<Edge> bridges;           ///< tree edges that are not neighbourhood: not in mesh.one_ring
  std::vector<LocalSurface> surfaces;  ///< n; the shadow of point i is surfaces[i].shadow
  NoiseLevel noise;
  std::size_t faceless = 0;        ///< vertices without a face
  bool on_shadow = false;          ///< whether the tests were made on the shadow
  std::vector<StageTime> seconds;  ///< in the order done
};

/// Connects n points (finite, in any frame; distinct where `make_working_cloud` made them, but coincident
/// ones do no harm). With `guide`, n smoothed positions of the same points: all tests, the EMST too, are made
/// on them, taken as free of noise; the mesh still has `points` as its positions. Any n, zero too, has a
/// result. Errors: usage (options), out_of_memory, cancelled. \throw std::invalid_argument if `guide` has
/// another size. O(n log n); parallel, the same bytes for any number of threads. Thread safe.
Result<Connection> connect(const Positions& points, const ConnectOptions& options, const Context& context,
                           const Positions* guide = nullptr);

/// The same for a caller who has an index over the points already and the rows of their nearest
/// `options.neighbours`. \throw std::invalid_argument if `near` is of another width or size.
Result<Connection> connect(SpatialIndex index, NeighborTable near, const ConnectOptions& options,
                           const Context& context);

}  // namespace rfsmooth::rfs_mesh
