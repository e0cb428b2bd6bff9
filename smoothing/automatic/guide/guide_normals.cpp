#include "smoothing/automatic/guide/guide_normals.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "rfs_mesh/fit/plane_normal.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/normals/sides.h"
#include "rfs_mesh/sample.h"
#include "rfs_mesh/search/thinning.h"

namespace rfsmooth::smoothing {

using rfs_mesh::kRing;
using rfs_mesh::NeighborTable;

namespace {

/// Turns the normals to one side along the surface.
void turn_to_one_side(const NeighborTable& near, std::vector<Eigen::Vector3f>& normals,
                      const Context& context) {
  const auto linked = [&](std::size_t i) {
    const auto row = near[i];
    return std::make_pair(row.begin(), row.begin() + std::min(row.size(), kRing));
  };
  const auto links = [&](std::size_t begin, std::size_t end, std::vector<rfs_mesh::SideLink>& out) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto [first, last] = linked(i);
      for (auto j = first; j != last; ++j) {
        const auto [back, stop] = linked(*j);
        if (*j < i && std::find(back, stop, Index(i)) != stop) continue;  // the other has this link
        const double agreement = normals[i].cast<double>().dot(normals[*j].cast<double>());
        out.push_back({Index(i), *j, float(agreement), 1});
      }
    }
  };
  const rfs_mesh::Regions regions = rfs_mesh::grow_regions_in_blocks(normals.size(), links, context);
  for_each_index(context, normals.size(), [&](std::size_t i) {
    if (regions.turned[i] != 0) normals[i] = -normals[i];
  });
}

}  // namespace

std::vector<Eigen::Vector3f> surface_normals(const Positions& points, const NeighborTable& near,
                                             const Context& context) {
  std::vector<Eigen::Vector3f> normals(points.size());
  for_each_index(context, points.size(), [&](std::size_t i) {
    const auto row = near[i];
    const Eigen::Vector3d normal = rfs_mesh::plane_normal(
        points, i, {row.begin(), row.begin() + std::min(row.size(), rfs_mesh::kNeighbourhood)});
    normals[i] = normal.allFinite() ? Eigen::Vector3f(normal.cast<float>()) : Eigen::Vector3f::UnitZ();
  });
  turn_to_one_side(near, normals, context);
  return normals;
}

std::vector<Eigen::Vector3f> normals_across_lines(const Positions& guide, const NeighborTable& near,
                                                  std::size_t across, const Context& context) {
  // How often is told by `across` alone, so that all parts of a cloud are thinned alike. Of the points on a
  // line a thinning leaves about a third: to either side of one that is kept the nearest goes.
  constexpr double kLeft = 1.0 / 3;
  std::vector<Index> kept = rfs_mesh::thin_all(guide, near, context);
  for (double left = kLeft; left * double(across) > double(rfs_mesh::kNarrowestPatch); left *= kLeft)
    if (kept.size() > 2 * kRing) kept = rfs_mesh::thin(guide, kept, context);
  const Positions at = rfs_mesh::at_rows(guide, kept, context);
  const rfs_mesh::SpatialIndex index(at, context);
  const std::vector<Eigen::Vector3f> known =
      surface_normals(at, index.nearest(int(2 * kRing), context), context);
  std::vector<Eigen::Vector3f> normals(guide.size());
  for_blocks(context, guide.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<rfs_mesh::Neighbor> found;
    for (std::size_t i = begin; i < end; ++i) {
      index.nearest(guide[i], int(std::min(kRing, at.size())), found);
      const double square = rfs_mesh::kJustBeyond * found.back().squared_distance;
      const Eigen::Vector3f& nearest = known[found.front().index];
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (const rfs_mesh::Neighbor& q : found) {
        const Eigen::Vector3f& normal = known[q.index];
        if (double(normal.dot(nearest)) < rfs_mesh::kSameSheet) continue;
        sum += float(square > 0 ? 1 - q.squared_distance / square : 1) * normal;
      }
      normals[i] = sum.normalized();
    }
  });
  return normals;
}

}  // namespace rfsmooth::smoothing
