/// Around each vertex a corona of faces "like a spanning umbrella" (Vollmer et al. section 7): the SDG edges
/// of the vertex, filled up with nearest neighbours "adaptive per vertex, estimated from the SDG", sorted
/// around it; consecutive ones span a face and its closing edge.
///
/// Differs from the paper: it does not say which neighbours. Ours are taken nearest first, leaving out
/// directions close to one already taken, so that the umbrella covers every side once.
#pragma once

#include <array>
#include <vector>

#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/mesh.h"
#include "rfsmooth/rfs_mesh/options.h"
#include "rfsmooth/rfs_mesh/sdg.h"

namespace rfsmooth::rfs_mesh {

inline constexpr int kMostRibs = 10;  ///< ribs of an umbrella: 360 / 30 degrees, less what the gaps eat

/// The thresholds of umbrellas, each with its reason.
struct UmbrellaOptions {
  /// Neighbours are looked for within this factor of the longest (90th percentile) SDG edge around the
  /// vertex.
  double fill = 1.4;
  int fewest = 6;         ///< a regular surface mesh has six neighbours,
  int most = 14;          ///< and twice as many lie within two rings' half way
  double rib_angle = 30;  ///< directions nearer than this to a taken one are left out
  double face_angle =
      120;  ///< consecutive ribs further apart span no face: a rim, or a hole for others to close
  double quality = 0.35;  ///< Bank & Smith quality below which a face is deleted (1 = equilateral)
  /// On a smooth surface the flattest of several pairs of faces is an accident of sampling: within this angle
  /// votes and quality choose (flattest_pair.h).
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

/// The ribs of one vertex, counter-clockwise about its normal; rib k and the next one span a face if bit k of
/// `faces` is set.
struct Umbrella {
  std::array<Index, kMostRibs> ribs;
  std::uint8_t count = 0;
  std::uint16_t faces = 0;

  bool spans(int k) const { return (faces >> k) & 1; }
  Index next(int k) const { return ribs[std::size_t(k + 1 == count ? 0 : k + 1)]; }
  /// Whether it spans the face with the corners a and b besides its own tip.
  bool spans(Index a, Index b) const {
    for (int k = 0; k < count; ++k)
      if (spans(k) &&
          ((ribs[std::size_t(k)] == a && next(k) == b) || (ribs[std::size_t(k)] == b && next(k) == a)))
        return true;
    return false;
  }
};

/// n umbrellas; `graph` is the SDG's adjacency. O(n k), parallel, deterministic.
std::vector<Umbrella> open_umbrellas(const Terrain& terrain, const Adjacency& graph,
                                     const UmbrellaOptions& options, const Context& context);

}  // namespace rfsmooth::rfs_mesh
