/// Compact groups of neighbouring points, of nearly the same size, that know nothing of points far away.
///
/// Space is divided into cubes, and the points of a cube are halved at the median of their widest axis until
/// the groups are small. So points beyond a cube have no say in its groups: a part of a cloud has the groups
/// of the whole where its cubes are complete. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::rfs_mesh {

/// The members of every group.
struct Groups {
  std::vector<Index> member;  ///< n: those of group g are member[start[g]] .. member[start[g + 1] - 1]
  std::vector<Index> start;   ///< groups + 1

  std::size_t size() const { return start.size() - 1; }
  Adjacency::Row operator[](std::size_t g) const {
    return {member.data() + start[g], member.data() + start[g + 1]};
  }
};

/// Groups of 3/4 to 3/2 of `members` points (>= 2), fewer where a cube holds fewer. \param edge of the cubes,
/// world units; 0: one cube for all. \param corner of one of them. \param points n x 3, finite. O(n log n),
/// parallel, deterministic.
Groups group_in_cells(const Positions& points, const Eigen::Vector3d& corner, double edge,
                      std::size_t members, const Context& context);

}  // namespace rfsmooth::rfs_mesh
