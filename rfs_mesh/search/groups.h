/// Compact groups of neighbouring points, of about the same size, that know nothing of points far away.
///
/// The points that a thinning (thinning.h) keeps are the centres, and every point joins the one nearest to
/// it; larger groups are made of the groups of a first step in a second, and so on. This depends on distances
/// among neighbours alone: groups turn with the cloud, do not know the order of the points, and those of a
/// part of a cloud are those of the whole but for a few near the cut. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The members of every group.
struct Groups {
  std::vector<Index>
      member;  ///< n: those of group g are member[start[g]] .. member[start[g + 1] - 1], ascending
  std::vector<Index> start;  ///< groups + 1

  std::size_t size() const { return start.size() - 1; }
  Adjacency::Row operator[](std::size_t g) const {
    return {member.data() + start[g], member.data() + start[g + 1]};
  }
};

/// Groups of about `members` points on the mean (>= 2), with a standard deviation of a third of it in one
/// step and of half of it in several. \param points n x 3, finite. \param near their nearest; a step makes
/// groups of up to half as many. O(n log n), parallel, deterministic.
Groups group_around_kept(const Positions& points, const NeighborTable& near, std::size_t members,
                         const Context& context);

}  // namespace rfsmooth::rfs_mesh
