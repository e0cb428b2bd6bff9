#include "pipeline/twins.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise.h"

namespace rfsmooth::pipeline {

namespace {

/// Squares, by point: as near are its twins. What is less beside the spacing cannot be told from one place.
std::vector<double> reaches_of_twins(const Positions& points, const rfs_mesh::NeighborTable& near,
                                     const Context& context) {
  std::vector<double> reach(points.size());
  for_each_index(context, points.size(), [&](std::size_t i) {
    const auto row = near[i];
    if (row.size() >= rfs_mesh::kRing)
      reach[i] = rfs_mesh::kNoNoise * rfs_mesh::kNoNoise *
                 (points[row[rfs_mesh::kRing - 1]] - points[i]).squaredNorm();
  });
  return reach;
}

}  // namespace

bool join_twins(const rfs_mesh::NeighborTable& near, rfs_mesh::WorkingCloud& cloud, const Context& context) {
  Positions& points = cloud.points;
  const std::vector<double> reach = reaches_of_twins(points, near, context);
  const auto are_twins = [&](std::size_t i, Index j) {
    return (points[j] - points[i]).squaredNorm() < reach[i];
  };
  const double having = sum_over(context, points.size(), 0.0, [&](std::size_t i) {
    return double(near[i].size() >= rfs_mesh::kRing && are_twins(i, near[i][0]));
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
  std::vector<Index> row_of(points.size(), kNone);
  for (std::size_t i = 0; i < cloud.of_input.size(); ++i)
    if (const Index p = cloud.of_input[i]; p != kNone && row_of[p] == kNone) row_of[p] = Index(i);
  cloud.like.assign(cloud.of_input.size(), kNone);
  for (std::size_t i = 0; i < cloud.of_input.size(); ++i) {
    Index& p = cloud.of_input[i];
    if (p == kNone) continue;
    if (const Index of = first[joined[p]]; of != p) cloud.like[i] = row_of[of];
    p = joined[p];
  }
  for (std::size_t k = 0; k < first.size(); ++k) points[k] = points[first[k]];
  points.resize(first.size());
  cloud.multiplicity.clear();
  return true;
}

}  // namespace rfsmooth::pipeline
