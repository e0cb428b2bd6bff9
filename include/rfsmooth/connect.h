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
/// Differs from the paper: connectivity is tested on the shadow of the cloud, its points put onto quadrics
/// fitted around them (LocalSurface), where noise exceeds a share of the spacing; points that noise carried
/// between two near sheets have no neighbours; thresholds are ours (SheetsOptions, SdgOptions,
/// UmbrellaOptions).
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>
#include <rfsmooth/options.h>

namespace rfsmooth {

/// When two sheets near each other are told apart (a thin plate, a fold): the thresholds, each with its
/// reason.
struct SheetsOptions {
  int looked_at = 48;  ///< shadows around a point: in each of two sheets as many as a neighbourhood has
  /// Gap over scatter within the sheets. A Gaussian cut in two at its middle has 2.2, an even slab 3.5.
  double apart = 5;
  /// Mean squared cosine between the normals and their axis: 27 degrees. Faces that meet at an edge have
  /// less.
  double parallel = 0.8;
  /// A sheet's centre lies at most this share of its extent beside the point's foot; beyond, the point looks
  /// at two surfaces side by side, as at a step.
  double beside = 0.5;
  /// Noise from which a point's distance to its sheet is worth a doubt; sheets are at least twice that apart.
  double far = 1.5;
  /// A point at least this share of the gap from the nearer sheet is between. At six standard deviations the
  /// odds for the farther one are there 1 : 37; what is missed is then a sixth of what crosses the middle.
  double between = 0.4;
  /// A shadow this far off its sheet is put onto it: twice what the quadrics' own scatter explains.
  double off = 0.8;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"sheets-looked-at", "shadows among which two sheets are looked for", "points", 16, 1000},
          self.looked_at);
    visit(OptionInfo{"sheets-apart", "gap from which there are two sheets", "x scatter within them", 1, 1e9},
          self.apart);
    visit(OptionInfo{"sheets-parallel", "mean squared cosine from which normals are parallel", "", 0, 1},
          self.parallel);
    visit(OptionInfo{"sheets-beside", "farthest that a sheet's centre lies beside the point", "x extent", 0,
                     100},
          self.beside);
    visit(OptionInfo{"sheets-far", "distance from its sheet at which a point is doubted", "x noise", 0, 1e9},
          self.far);
    visit(OptionInfo{"sheets-between", "nearer the middle than this a point has no neighbours", "x gap", 0,
                     0.5},
          self.between);
    visit(OptionInfo{"sheets-off", "a shadow farther from its sheet is put onto it", "x noise", 0, 1e9},
          self.off);
  }
};

/// The rules that extend the EMST to the SDG: the thresholds, each with its reason.
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

/// The thresholds of umbrellas, each with its reason.
struct UmbrellaOptions {
  /// Neighbours are looked for within this factor of the longest (90th percentile) SDG edge around the
  /// vertex.
  double fill = 1.4;
  int fewest = 6;         ///< a regular surface mesh has six neighbours,
  int most = 14;          ///< and twice as many lie within two rings' half way
  double rib_angle = 30;  ///< directions nearer than this to a taken one are left out; ten are the most
  double face_angle =
      120;  ///< consecutive ribs further apart span no face: a rim, or a hole for others to close
  double quality = 0.35;  ///< Bank & Smith quality below which a face is deleted (1 = equilateral)
  /// Of the faces that umbrellas propose at an edge the flattest pair stays. On a smooth surface which that
  /// is is an accident of sampling: within this angle votes and quality choose.
  double same_fold = 10;
  double normal_angle = 60;  ///< as in the SDG: ribs stay on one sheet
  double steepness = 0.75;   ///< as in the SDG, but a rib may bend further than an edge chosen to lead on

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"umbrella-fill", "how far an umbrella is filled with nearest neighbours",
                     "x 90th percentile SDG edge", 0, 100},
          self.fill);
    visit(OptionInfo{"umbrella-fewest", "fewest nearest neighbours considered", "points", 0, 64},
          self.fewest);
    visit(OptionInfo{"umbrella-most", "most nearest neighbours considered", "points", 0, 64}, self.most);
    visit(OptionInfo{"umbrella-rib-angle", "smallest angle between ribs", "degrees", 0, 180}, self.rib_angle);
    visit(
        OptionInfo{"umbrella-face-angle", "largest angle of a face at the umbrella's tip", "degrees", 0, 180},
        self.face_angle);
    visit(OptionInfo{"umbrella-quality", "smallest Bank & Smith quality of a face", "", 0, 1}, self.quality);
    visit(OptionInfo{"umbrella-same-fold", "dihedral angles count as equal within steps of this", "degrees",
                     0.1, 180},
          self.same_fold);
    visit(OptionInfo{"umbrella-normal-angle", "largest angle between normals along a rib", "degrees", 0, 90},
          self.normal_angle);
    visit(OptionInfo{"umbrella-steepness", "largest rise over run of a rib", "", 0, 100}, self.steepness);
  }
};

/// The last stage of connecting that is wanted; what only later ones make stays empty. `emst`: the tree of
/// the points, no noise is measured; `tree`: the tree that the SDG extends, which stands on the shadow where
/// noise is large.
enum class ConnectUpTo { emst, tree, sdg, mesh };

/// How to connect.
struct ConnectOptions {
  int neighbours = 24;       ///< nearest neighbours looked at; about two and a half rings of a surface mesh
  double shadow_from = 0.3;  ///< noise / spacing from which tests are made on the shadow
  SheetsOptions sheets;
  SdgOptions sdg;
  UmbrellaOptions umbrella;

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

/// The surface around a point, as its neighbours show it.
struct LocalSurface {
  Eigen::Vector3d normal;  ///< unit; its side is arbitrary
  Eigen::Vector3d shadow;  ///< the point moved along the normal onto its quadric, same frame as the points
  double residual = 0;     ///< sqrt(weighted RSS / degrees of freedom): local noise, world units
};

/// Spacing and noise of a cloud.
struct NoiseLevel {
  double spacing = 0;  ///< h: mean distance to the nearest neighbour, world units
  double sigma = 0;    ///< standard deviation of the noise along the normal, world units
};

/// Everything the stages made. All of it refers to the points by index.
struct Connection {
  Mesh mesh;                           ///< the RFS-mesh over the points as given
  std::vector<Edge> emst;              ///< n - 1, ascending by length; of the points
  std::vector<Edge> tree;              ///< what the SDG extends, ascending: the EMST, or that of the
                                       ///< shadows
  std::vector<Edge> sdg;               ///< ascending; without the bridges
  std::vector<Edge> bridges;           ///< tree edges that are not neighbourhood: not in mesh.one_ring
  std::vector<LocalSurface> surfaces;  ///< n; the shadow of point i is surfaces[i].shadow
  NoiseLevel noise;
  std::size_t faceless = 0;        ///< vertices without a face
  bool on_shadow = false;          ///< whether the tests were made on the shadow
  std::vector<StageTime> seconds;  ///< in the order done
};

/// Connects n points (finite, in any frame; coincident ones do no harm), up to a stage. Any n, zero too, has
/// a result. Errors: usage (options), out_of_memory, cancelled. O(n log n); parallel, the same bytes for any
/// number of threads. Thread safe.
Result<Connection> connect(const Positions& points, const ConnectOptions& options, const Context& context,
                           ConnectUpTo up_to = ConnectUpTo::mesh);

/// When a dihedral edge swap is worth it.
struct SwapOptions {
  /// Gain below which a swap is not worth it (and rounding could undo it next time).
  double least_gain = 1e-3;
  /// New faces have at least this Bank & Smith quality, or the old pair's lower one if that is less.
  double quality = 0.25;
  int rounds = 1;  ///< sets of independent swaps in one pass; what one leaves, the next pass finds

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"swap-least-gain", "smallest gain in the sum of dihedral angles", "radians", 0, 100},
          self.least_gain);
    visit(OptionInfo{"swap-quality", "smallest Bank & Smith quality a swap may leave", "", 0, 1},
          self.quality);
    visit(OptionInfo{"swap-rounds", "sets of independent swaps in one pass", "", 1, 1000}, self.rounds);
  }
};

}  // namespace rfsmooth
