#include "rfs_mesh/normals/visible.h"

#include <algorithm>
#include <unordered_map>

#include "base/parallel.h"
#include "base/quantile.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

constexpr double kCell = 3, kBehind = 10;  // spacings

/// The cell of a direction: the face of the cube by the largest coordinate, then rows and columns.
std::size_t cell_of(const Vector3d& direction, std::size_t cells) {
  Eigen::Index axis = 0;
  const double largest = direction.cwiseAbs().maxCoeff(&axis);
  const auto place = [&](double c) {
    const double share = (c / largest + 1) / 2;
    return std::min(cells - 1, std::size_t(share * double(cells)));
  };
  const std::size_t face = 2 * std::size_t(axis) + (direction[axis] < 0 ? 1 : 0);
  return (face * cells + place(direction[(axis + 1) % 3])) * cells + place(direction[(axis + 2) % 3]);
}

}  // namespace

std::vector<double> seen_squarely(const Positions& points, const Positions& normals,
                                  const Vector3d& viewpoint, double spacing, const Context& context) {
  const std::size_t n = points.size();
  std::vector<double> seen(n, 0), distance(n);
  if (n == 0) return seen;
  for_each_index(context, n, [&](std::size_t i) { distance[i] = (points[i] - viewpoint).norm(); });
  std::vector<double> sorted = distance;
  const double wanted = 2 * median(sorted) / (kCell * spacing);
  const auto cells = std::size_t(std::clamp(wanted, 1.0, double(n)));
  std::vector<std::size_t> cell(n);
  for_each_index(context, n, [&](std::size_t i) {
    if (distance[i] > 0) cell[i] = cell_of(points[i] - viewpoint, cells);
  });
  std::unordered_map<std::size_t, double> nearest;  // of the cells that hold points
  for (std::size_t i = 0; i < n; ++i) {
    if (!(distance[i] > 0)) continue;
    double& least = nearest.try_emplace(cell[i], distance[i]).first->second;
    least = std::min(least, distance[i]);
  }
  for_each_index(context, n, [&](std::size_t i) {
    if (!(distance[i] > 0)) return;
    if (distance[i] <= nearest.at(cell[i]) + kBehind * spacing)
      seen[i] = normals[i].dot(viewpoint - points[i]) / distance[i];
  });
  return seen;
}

}  // namespace rfsmooth::rfs_mesh
