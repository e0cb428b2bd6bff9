#include "rfsmooth/pipeline/normals.h"

#include <limits>
#include <vector>

#include "rfsmooth/rfs_mesh/bilateral_normals.h"
#include "rfsmooth/rfs_mesh/orient.h"
#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/rfs_mesh/rfs_mesh.h"

namespace rfsmooth::pipeline {

namespace {

constexpr int kFiltered = 96;  // neighbours over which normals are made calm

NormalsReport run(const double* xyz, std::size_t n, const NormalsOptions& options, const Context& context,
                  double* normals) {
  NormalsReport report;
  report.points = n;
  const rfs_mesh::WorkingCloud cloud = value_or_throw(rfs_mesh::make_working_cloud(xyz, n, context));
  report.finite = cloud.finite();
  const rfs_mesh::Connection connection = value_or_throw(rfs_mesh::connect(cloud.points, {}, context));
  context.report("normals", 0);
  Positions calm = cloud.points, side(calm.size());
  std::vector<double> scatter(calm.size());
  for_each_index(context, side.size(), [&](std::size_t i) {
    side[i] = connection.surfaces[i].normal;
    scatter[i] = connection.surfaces[i].residual;
    if (connection.on_shadow) calm[i] = connection.surfaces[i].shadow;
  });
  {
    const rfs_mesh::SpatialIndex index(calm, context);
    bilateral_normals(calm, index.nearest(kFiltered, context), scatter, side, context);
  }
  std::optional<Eigen::Vector3d> viewpoint = options.viewpoint;
  if (viewpoint) *viewpoint -= cloud.origin;
  report.parts =
      orient(connection.mesh, connection.emst, connection.bridges, viewpoint, side, context, &calm);
  context.check_stop();
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
    in_arena(context, [&] { report = run(xyz, n, options, context, normals); });
    return report;
  });
}

}  // namespace rfsmooth::pipeline
