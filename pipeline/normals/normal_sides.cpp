#include "pipeline/normals/normal_sides.h"

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::pipeline {

namespace {

using Vectors = Eigen::Map<const Eigen::Matrix3Xd>;

/// a of every working point: the sum over the rows that share it.
std::vector<double> agreements(const rfs_mesh::WorkingCloud& cloud, const Vectors& before,
                               const Vectors& normals) {
  std::vector<double> a(cloud.points.size(), 0);
  for (std::size_t i = 0; i < cloud.of_input.size(); ++i) {
    const Index p = cloud.of_input[i];
    const auto row = Eigen::Index(i);
    if (p == kNone) continue;
    const double length = before.col(row).norm(), dot = normals.col(row).dot(before.col(row));
    if (length > 0 && std::isfinite(length) && std::isfinite(dot)) a[p] += dot / length;
  }
  return a;
}

}  // namespace

bool keep_sides(const double* xyz, std::size_t n, const double* before, double* normals,
                const Context& context) {
  const auto working = rfs_mesh::make_working_cloud(xyz, n, context);
  if (!working.ok()) return false;
  const rfs_mesh::WorkingCloud& cloud = working.value();
  const std::vector<double> a =
      agreements(cloud, Vectors(before, 3, Eigen::Index(n)), Vectors(normals, 3, Eigen::Index(n)));

  const rfs_mesh::SpatialIndex index(cloud.points, context);
  // Random sides give sum |v| / sum |a| of sqrt(2 / (25 pi)), about 0.16.
  const rfs_mesh::NeighborTable near = index.nearest(int(rfs_mesh::kNeighbourhood), context);
  std::vector<double> vote(a.size()), most(a.size());
  for_each_index(context, a.size(), [&](std::size_t p) {
    vote[p] = a[p];
    most[p] = std::abs(a[p]);
    if (near.k == 0) return;
    for (const Index q : near[p]) {
      vote[p] += a[q];
      most[p] += std::abs(a[q]);
    }
  });
  const auto sums = sum_over(context, a.size(), Eigen::Vector2d(0, 0),
                             [&](std::size_t p) { return Eigen::Vector2d(std::abs(vote[p]), most[p]); });
  if (!(sums[0] > 0.5 * sums[1])) return false;

  for_each_index(context, n, [&](std::size_t i) {
    const Index p = cloud.of_input[i];
    if (p == kNone || vote[p] >= 0) return;
    for (std::size_t axis = 0; axis < 3; ++axis) normals[3 * i + axis] = -normals[3 * i + axis];
  });
  return true;
}

}  // namespace rfsmooth::pipeline
