#include "rfs_mesh/normals/wall_sides.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "base/parallel.h"
#include "rfs_mesh/fit/tangent_plane.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/sheets/two_sheets.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Whether there is another sheet: a single normal is none.
bool faces_another(const Positions& normals, std::size_t i, const Adjacency::Row& row) {
  std::size_t opposite = 0;
  for (const Index j : row) opposite += normals[i].dot(normals[j]) < -kSameSheet ? 1 : 0;
  return opposite > 1;
}

/// Whether the point i lies on the other sheet of a wall.
bool on_other_sheet(const Positions& points, const Positions& normals, std::size_t i,
                    const Adjacency::Row& row) {
  const Eigen::Vector3d& normal = normals[i];
  const TangentPlane plane(normal);
  double square = 0;
  for (const Index j : row) square = std::max(square, kJustBeyond * (points[j] - points[i]).squaredNorm());
  if (!(square > 0)) return false;
  const double in_radii = 1 / std::sqrt(square);
  LabelledSheets sheets;
  for (const Index j : row) {
    const double cosine = normal.dot(normals[j]);
    if (std::abs(cosine) < kSameSheet) continue;
    const Eigen::Vector3d r = in_radii * (points[j] - points[i]);
    const double inside = 1 - r.squaredNorm(), weight = inside * inside;
    sheets.add(plane.project(r), normal.dot(r), cosine < 0 ? -1 : 1, weight);
  }
  const LabelledSheets::Fit fit = sheets.fit();
  return fit.middle > 0 && fit.middle < 2 * fit.apart && fit.variance < fit.apart * fit.apart;
}

}  // namespace

std::size_t turn_to_own_sheet(const Positions& points, const NeighborTable& near, Positions& normals,
                              const Context& context) {
  if (normals.size() != points.size() || (near.k > 0 && near.size() != points.size()))
    throw std::invalid_argument("turn_to_own_sheet: points, neighbours and normals differ in number");
  if (near.k == 0) return 0;
  std::vector<char> other(points.size());
  std::size_t all = 0, before = 0, turned = 0;
  do {  // a side that was put right helps others, while there are ever fewer
    for_each_index(context, points.size(), [&](std::size_t i) {
      const Adjacency::Row row = near[i];
      other[i] = char(faces_another(normals, i, row) && on_other_sheet(points, normals, i, row));
    });
    for (std::size_t i = 0; i < points.size(); ++i)
      if (other[i] != 0) normals[i] = -normals[i];
    before = std::exchange(turned, std::size_t(std::count(other.begin(), other.end(), 1)));
    all += turned;
  } while (turned > 0 && (before == 0 || turned < before));
  return all;
}

}  // namespace rfsmooth::rfs_mesh
