/// The working points of a cloud in the order of its file.
#pragma once

#include <vector>

#include "rfs_mesh/points.h"

namespace rfsmooth::pipeline {

/// The working points in the order in which their rows first come.
struct RowOrder {
  std::vector<std::size_t> row;  ///< m, ascending: the first row of each
  std::vector<Index> rank;       ///< m: the place of each working point in that order
};

/// Of all working points. O(n). Thread safe.
inline RowOrder row_order(const rfs_mesh::WorkingCloud& cloud) {
  RowOrder order;
  order.rank.assign(cloud.points.size(), kNone);
  for (std::size_t i = 0; i < cloud.of_input.size(); ++i) {
    const Index p = cloud.of_input[i];
    if (p == kNone || order.rank[p] != kNone) continue;
    order.rank[p] = Index(order.row.size());
    order.row.push_back(i);
  }
  return order;
}

}  // namespace rfsmooth::pipeline
