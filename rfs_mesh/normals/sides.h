/// Which of neighbouring normals are on one side: points grow together into regions, the surest first.
///
/// A link says of two normals that they agree (positive) or not, with |agreement| <= 1. Each region joins the
/// neighbour with which the links between the two, summed up, say most clearly how,
///
///     clarity = (sum of agreements)^2 / number of links,
///
/// at first only where clarity is at least 0.8 (one link in a plane has 1, noise about its variance whatever
/// the number), then 0.6, ... 0: so doubtful points wait until their neighbours speak with one voice. Kruskal
/// on single links, as in Hoppe et al. 1992, is turned over by one wrong link between two large parts.
///
/// A vote says which side a point is on by other evidence (positive: its normal is right). Regions whose
/// votes speak against a join more loudly than the links for it stay apart.
/// The functions are thread safe; a Sides object is for one thread.
#pragma once

#include <algorithm>
#include <functional>
#include <numeric>
#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::rfs_mesh {

/// Union-find whose members know whether they are turned against their root; the lowest index is the root.
class Sides {
 public:
  explicit Sides(std::size_t n) : parent_(n), turned_(n, 0) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  /// Where a member hangs.
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
  /// Joins two different roots; `turned`: against each other.
  void join(Index a, Index b, bool turned) {
    parent_[std::max(a, b)] = std::min(a, b);
    turned_[std::max(a, b)] = turned ? 1 : 0;
  }

 private:
  std::vector<Index> parent_;
  std::vector<char> turned_;
};

/// How well the sides of two points, or regions, agree.
struct SideLink {
  Index a, b;
  float agreement;  ///< of all links in it
  float count;      ///< how many links it stands for, 1 to begin with
};

/// Which points have found one side together.
struct Regions {
  std::vector<Index> of_point;  ///< n: the region's lowest point
  std::vector<char> turned;     ///< n: 1 where the normal is on the other side than the lowest point's
};

/// `links` in any order, a != b; `votes`: n, or empty for none. O(E log E) in all. Parallel where it counts;
/// the same for any number of threads.
Regions grow_regions(std::size_t n, std::vector<SideLink> links, const std::vector<double>& votes,
                     const Context& context);

/// The links of the points [begin, end), to be appended to `out`.
using LinksOf = std::function<void(std::size_t begin, std::size_t end, std::vector<SideLink>& out)>;

/// The same of many points that lie in memory about as in space, without ever holding all links: first the
/// points of every block of 4096 grow together by the surest of the links among them, at least 0.8, then the
/// regions of the blocks as above. Parallel; the same for any number of threads.
Regions grow_regions_in_blocks(std::size_t n, const LinksOf& links, const Context& context);

}  // namespace rfsmooth::rfs_mesh
