/// What lies around a tile and has a say in where its points go.
///
/// A patch of so many points is wide where points are sparse: scans have fewer of them in an area far away
/// than near by. So the width of the halo is in units of the widest patch around each part of the
/// tile, not of the cloud's typical one.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::pipeline::tiles {

/// The halo is this many radii of the widest patch. What a point becomes passes through such patches six
/// times: from their members to them and from them to the point, for the heights and twice more for the means
/// of the evidence. The weights (1 - d^2)^2 have a standard deviation of 0.35 radii, six in a row 0.87, and
/// this is 3.5 of those.
constexpr double kHaloRadii = 3;

/// Each place once, in the order of the first points there: a patch counts those, however many rows there
/// are. O(n log n).
Positions distinct_places(const Positions& points);

/// The median distance to the m-th neighbour, of up to 1,000 points. O(m) after the index.
double typical_radius(const Positions& points, std::size_t m, const Context& context);

/// A tile's surroundings: the points that are nearer to a part of it than the part reaches.
class Halo {
 public:
  /// \param points distinct places, the tile's own first, then others within `radius` of its box, if they are
  /// there: where they are missing at its rim, patches seem wider than they are and the halo is the wider for
  /// it. \param own how many are the tile's. \param m points of the widest patch. \param radii how many of
  /// its radii a part reaches.
  Halo(const Positions& points, std::size_t own, std::size_t m, double radii, const Context& context);

  bool holds(const Eigen::Vector3d& p) const;
  /// Whether it may hold points of the box.
  bool meets(const Eigen::AlignedBox3d& box) const;
  /// Makes it narrower or wider.
  void scale(double times);

 private:
  struct Part {
    Eigen::AlignedBox3d box;
    double reach = 0;
  };
  std::vector<Part> parts_;
  std::vector<Eigen::AlignedBox3d> groups_;  ///< of kGroup parts each, with their reach
  void group();
};

}  // namespace rfsmooth::pipeline::tiles
