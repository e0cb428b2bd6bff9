/// Around each vertex a corona of faces "like a spanning umbrella" (Vollmer et al. section 7). Its ribs are
/// the SDG edges of the vertex and nearest neighbours, "adaptive per vertex, estimated from the SDG", sorted
/// around the vertex. Consecutive ribs and the edge between their ends span a face.
///
/// Differs from the paper: it does not say which neighbours. Ours are taken nearest first; directions
/// close to one already taken are left out, so that the umbrella covers every side once. Thread safe: no
/// state is kept.
#pragma once

#include <array>
#include <vector>

#include <rfsmooth/connect.h>

#include "rfs_mesh/connect/sdg.h"

namespace rfsmooth::rfs_mesh {

inline constexpr int kMostRibs = 10;  ///< ribs of an umbrella: 360 / 30 degrees are 12, and gaps take some

/// The ribs of one vertex, counter-clockwise about its normal; rib k and the next one span a face if bit k of
/// `faces` is set.
struct Umbrella {
  std::array<Index, kMostRibs> ribs;
  std::uint8_t count = 0;
  std::uint16_t faces = 0;

  bool spans(int k) const { return (faces >> k) & 1; }
  Index next(int k) const { return ribs[std::size_t(k + 1 == count ? 0 : k + 1)]; }
  /// Whether it spans the face of its vertex, a and b.
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
