#include <algorithm>
#include <limits>
#include <vector>

#include <rfsmooth/connect.h>
#include <rfsmooth/normals.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/normals/normals_by_part.h"
#include "rfs_mesh/connect/connect.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/normals/bilateral_normals.h"
#include "rfs_mesh/normals/orient.h"
#include "rfs_mesh/normals/thin_parts.h"
#include "rfs_mesh/normals/wall_sides.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth {

using namespace rfs_mesh;

namespace {

constexpr int kFiltered = 128;  // neighbours over which normals are made calm

/// A normal more than 60 degrees off the mean of the 24 nearest takes that mean, unless those disagree among
/// themselves, as across a thin wall or at the tip of a wedge. Needed by few, most of them in creases, where
/// the filter has taken the side of one flank too many.
void settle(const Positions& points, const rfs_mesh::SpatialIndex& index, const Mesh& mesh,
            Positions& normals, const Context& context) {
  Positions settled = normals;
  for_blocks(context, normals.size(), 4096, [&](std::size_t begin, std::size_t end) {
    std::vector<rfs_mesh::Neighbor> near;
    for (std::size_t i = begin; i < end; ++i) {
      const auto ring = mesh.one_ring[i];
      if (std::none_of(ring.begin(), ring.end(),
                       [&](Index j) { return normals[i].dot(normals[j]) < kSameSheet; }))
        continue;
      index.nearest(points[i], int(kNeighbourhood) + 1, near);
      const double square = kBeyond * near.back().squared_distance;
      if (!(square > 0)) continue;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double weights = 0;
      for (const auto& q : near) {
        const double inside = 1 - q.squared_distance / square, weight = inside * inside;
        sum += weight * normals[q.index];
        weights += weight;
      }
      const double length = sum.norm();
      if (length > kSameSheet * weights && normals[i].dot(sum) < kSameSheet * length)
        settled[i] = sum / length;
    }
  });
  normals.swap(settled);
}

/// `part`: as in normals_by_part, or null.
NormalsReport run(const double* xyz, std::size_t n, const NormalsOptions& options, const Context& context,
                  double* normals, std::vector<Index>* part) {
  NormalsReport report;
  report.points = n;
  if (options.viewpoint && !options.viewpoint->allFinite())
    fail(ErrorCode::usage, "the viewpoint is not finite");
  const rfs_mesh::WorkingCloud cloud = value_or_throw(rfs_mesh::make_working_cloud(xyz, n, context));
  report.finite = cloud.finite();
  rfs_mesh::Wanted wanted;
  wanted.emst = false;  // bridges are of the other tree
  const Connection connection = value_or_throw(rfs_mesh::connect(cloud.points, {}, wanted, context));
  context.report("normals", 0);
  Positions calm = cloud.points, side(calm.size());
  std::vector<double> scatter(calm.size());
  for_each_index(context, side.size(), [&](std::size_t i) {
    side[i] = connection.surfaces[i].normal;
    scatter[i] = connection.surfaces[i].residual;
    if (connection.on_shadow) calm[i] = connection.surfaces[i].shadow;
  });
  const rfs_mesh::SpatialIndex index(calm, context);
  const rfs_mesh::NeighborTable near = index.nearest(kFiltered, context);
  bilateral_normals(calm, near, scatter, side, context);
  std::optional<Eigen::Vector3d> viewpoint = options.viewpoint;
  if (viewpoint) *viewpoint -= cloud.origin;
  report.parts =
      orient(connection.mesh, connection.tree, connection.bridges, viewpoint, side, context, &calm, part);
  settle(calm, index, connection.mesh, side, context);
  if (!viewpoint) rfs_mesh::turn_out_of_thin_parts(index, side, context);
  rfs_mesh::turn_to_own_sheet(cloud.points, near, side, context);
  context.check_stop();
  if (part != nullptr) {
    std::vector<Index> of_row(n, kNone);
    for (std::size_t i = 0; i < n; ++i)
      if (const Index p = cloud.of_input[i]; p != kNone) of_row[i] = (*part)[p];
    part->swap(of_row);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Index p = cloud.of_input[i];
    for (int axis = 0; axis < 3; ++axis)
      normals[3 * i + std::size_t(axis)] =
          p == kNone ? std::numeric_limits<double>::quiet_NaN() : side[p][axis];
  }
  context.report("normals", 1);
  return report;
}

}  // namespace

Result<NormalsReport> estimate_normals(const double* xyz, std::size_t n, const NormalsOptions& options,
                                       const Context& context, double* normals) {
  return guarded([&] {
    NormalsReport report;
    in_arena(context, [&] { report = run(xyz, n, options, context, normals, nullptr); });
    return report;
  });
}

NormalsReport pipeline::normals_by_part(const double* xyz, std::size_t n, const NormalsOptions& options,
                                        const Context& context, double* normals, std::vector<Index>& part) {
  NormalsReport report;
  in_arena(context, [&] { report = run(xyz, n, options, context, normals, &part); });
  return report;
}

}  // namespace rfsmooth
