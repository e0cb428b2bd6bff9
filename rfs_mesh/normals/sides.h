/// Which of neighbouring normals are on one side: points grow together into regions, the surest first.
///
/// A link says whether two normals agree: agreement in [-1, 1], positive if they do. Each region joins the
/// neighbouring region for which the sum of the links between the two is clearest,
///
///     clarity = (sum of agreements)^2 / number of links.
///
/// At first only joins with clarity of at least 0.8 are made (one link in a plane has 1; pure noise has about
/// its variance, whatever the number of links), then 0.6, ... 0: doubtful points wait until their neighbours
/// agree. Kruskal on single links, as in Hoppe et al. 1992, fails at one wrong link between two large parts.
///
/// A vote is other evidence on the side of a point (positive: its normal is right). Two regions stay apart if
/// their votes count more against the join than the links for it. The functions are thread safe; a Sides
/// object is for one thread.
#pragma once

#include <algorithm>
#include <functional>
#include <numeric>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::rfs_mesh {

/// Union-find that also stores whether each member is turned against its root, the lowest index of the set.
class Sides {
 public:
  explicit Sides(std::size_t n) : parent_(n), turned_(n, 0) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  /// The root of a member, and whether the member is turned against it.
  struct Root {
    Index index;
    bool turned;
  };
  Root find(Index i) {
    bool turned = false;
    while (parent_[i] != i) {
      const Index up = parent_[i];
      turned_[i] = char(turned_[i] ^ turned_[up]);  // path halving: now relative to the grandparent
      parent_[i] = parent_[up];
      turned ^= turned_[i] != 0;
      i = parent_[i];
    }
    return {i, turned};
  }
  /// Joins two different roots. `turned`: whether they are turned against each other.
  void join(Index a, Index b, bool turned) {
    parent_[std::max(a, b)] = std::min(a, b);
    turned_[std::max(a, b)] = turned ? 1 : 0;
  }

 private:
  std::vector<Index> parent_;
  std::vector<char> turned_;
};

/// Whether v points down: its last coordinate that is not zero is negative.
bool points_down(const Eigen::Vector3d& v);

/// Whether a part of the surface is on the wrong side: by its votes where it has any, else by the volume
/// within it, which is negative inside out, else, where it is flat, by the sum of its normals. \param volume
/// the sum of a (p - c) . n over its points p, which have the area a and the normal n; c is their middle.
/// \param extent the sum of a |p - c|. Both may be in any unit, which must be the same.
bool on_wrong_side(double vote, double volume, double extent, const Eigen::Vector3d& normals);

/// How well the sides of two points, or of two regions, agree.
struct SideLink {
  Index a, b;
  float agreement;  ///< sum over its links
  float count;      ///< number of links summed, 1 to begin with
};

/// The regions of n points, and the side of each point in its region.
struct Regions {
  std::vector<Index> of_point;  ///< n: the region's lowest point
  std::vector<char> turned;     ///< n: 1 where the normal is on the other side than the lowest point's
};

/// Grows the regions of n points. `links`: in any order, a != b; `votes`: n, or empty for none. O(E log E).
/// Mostly parallel; the same for any number of threads.
Regions grow_regions(std::size_t n, std::vector<SideLink> links, const std::vector<double>& votes,
                     const Context& context);

/// Appends the links of the points [begin, end) to `out`.
using LinksOf = std::function<void(std::size_t begin, std::size_t end, std::vector<SideLink>& out)>;

/// The same for many points that lie in memory about as in space, without holding all links at once. First
/// the points of every block of 4096 grow together by links among them of at least 0.8, then the regions of
/// the blocks as above. Parallel; the same for any number of threads.
Regions grow_regions_in_blocks(std::size_t n, const LinksOf& links, const Context& context);

}  // namespace rfsmooth::rfs_mesh
