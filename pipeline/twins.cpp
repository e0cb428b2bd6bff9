#include "pipeline/twins.h"

#include <vector>

#include "base/parallel.h"
#include "pipeline/row_order.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"

namespace rfsmooth::pipeline {

bool join_twins(const rfs_mesh::NeighborTable& near, rfs_mesh::WorkingCloud& cloud, const Context& context) {
  using rfs_mesh::kNoNoise, rfs_mesh::kRing;
  Positions& points = cloud.points;
  // What is less beside the spacing cannot be told from one place.
  const auto are_twins = [&](std::size_t i, Index j) {
    const auto row = near[i];
    return row.size() >= kRing &&
           (points[j] - points[i]).squaredNorm() <
               kNoNoise * kNoNoise * (points[row[kRing - 1]] - points[i]).squaredNorm();
  };
  const double having = sum_over(context, points.size(), 0.0, [&](std::size_t i) {
    return double(near[i].size() > 0 && are_twins(i, near[i][0]));
  });
  if (!(having >= rfs_mesh::kLeastPart * double(points.size())) || points.empty()) return false;

  std::vector<Index> joined(points.size(), kNone);  // the new number of each, or of its twin
  std::vector<Index> first;                         // by new number: the point
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (joined[i] != kNone) continue;
    joined[i] = Index(first.size());
    first.push_back(Index(i));
    for (const Index j : near[i])
      if (joined[j] == kNone && are_twins(i, j)) joined[j] = joined[i];
  }
  const RowOrder rows = row_order(cloud);
  cloud.like.assign(cloud.of_input.size(), kNone);
  cloud.multiplicity.assign(first.size(), 0);
  for (std::size_t i = 0; i < cloud.of_input.size(); ++i) {
    Index& p = cloud.of_input[i];
    if (p == kNone) continue;
    if (const Index of = first[joined[p]]; of != p) cloud.like[i] = Index(rows.row[rows.rank[of]]);
    p = joined[p];
    ++cloud.multiplicity[p];
  }
  for (std::size_t k = 0; k < first.size(); ++k) points[k] = points[first[k]];
  points.resize(first.size());
  return true;
}

}  // namespace rfsmooth::pipeline
