#include <algorithm>
#include <limits>

#include <Eigen/Geometry>

#include <rfsmooth/reconstruct.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "pipeline/row_order.h"
#include "pipeline/surface/hole_filling.h"
#include "pipeline/surface/pinches.h"
#include "pipeline/surface/surface_cleanup.h"
#include "pipeline/surface/topology.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth {

using namespace pipeline;

namespace {

double spacing_of(const Positions& points, const Context& context) {
  const rfs_mesh::SpatialIndex index(points, context);
  return rfs_mesh::mean_spacing(points, index.nearest(1, context), context);
}

/// Whether all points are on one line but for the rounding of float32. O(n).
bool on_one_line(const Positions& points) {
  const auto farthest_from = [&](const Eigen::Vector3d& p) {
    return *std::max_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
      return (a - p).squaredNorm() < (b - p).squaredNorm();
    });
  };
  const Eigen::Vector3d end = farthest_from(points.front());
  const Eigen::Vector3d along = farthest_from(end) - end;
  const double rounding = 2 * double(std::numeric_limits<float>::epsilon()) * along.norm();
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
    return (p - end).cross(along).norm() <= rounding * along.norm();
  });
}

/// Takes the noise out of the rows, and outliers, where they were looked for, out of the cloud.
void clean(std::vector<double>& xyz, const DenoiseOptions& options, ReconstructReport& report,
           const Context& context) {
  report.denoised = value_or_throw(denoise(xyz.data(), xyz.size() / 3, options, context));
  report.seconds = report.denoised.seconds;
  for (std::size_t i = 0; i < report.denoised.outlier.size(); ++i)
    if (report.denoised.outlier[i]) xyz[3 * i] = std::numeric_limits<double>::quiet_NaN();
}

/// The normals of the working points.
Positions working_normals(const std::vector<double>& xyz, const rfs_mesh::WorkingCloud& cloud,
                          const NormalsOptions& options, const Context& context) {
  const std::size_t n = xyz.size() / 3;
  std::vector<double> of_row(xyz.size());
  value_or_throw(estimate_normals(xyz.data(), n, options, context, of_row.data()));
  Positions normals(cloud.points.size());
  for (std::size_t i = 0; i < n; ++i)
    if (const Index p = cloud.of_input[i]; p != kNone) normals[p] = Eigen::Vector3d::Map(&of_row[3 * i]);
  return normals;
}

/// What the methods leave undone.
void clean_up(Mesh& mesh, const SurfaceInput& input, const ReconstructOptions& options, bool closes_all,
              ReconstructReport& report, const Context& context) {
  // A closed piece of a hundred points, two faces a point; a method that closes gaps makes larger ones.
  const std::size_t speck = closes_all ? 100 : 200;
  report.raw_faces = mesh.faces.size();
  const double trim = options.trim.resolve(input.spacing),
               longest = options.fill_holes.resolve(input.spacing);
  if (closes_all && trim > 0) trim_far_faces(mesh, input.points, trim, context);
  part_pinches(mesh, context);
  drop_specks(mesh, speck, context);
  if (longest > 0) report.filled = fill_holes(mesh, longest, context);
  drop_unused_vertices(mesh, context);
}

Reconstruction run(std::vector<double> xyz, const ReconstructOptions& options, const SurfaceMethod& method,
                   const Context& context) {
  Reconstruction made;
  ReconstructReport& report = made.report;
  if (options.denoise) clean(xyz, options.denoising, report, context);
  {
    Stopwatch watch(report.seconds, "normals");
    const rfs_mesh::WorkingCloud cloud =
        value_or_throw(rfs_mesh::make_working_cloud(xyz.data(), xyz.size() / 3, context));
    if (cloud.points.size() < 4)
      fail(ErrorCode::no_usable_points, "a surface needs four distinct points at least");
    if (on_one_line(cloud.points))
      fail(ErrorCode::no_usable_points, "all points are on one line: there is no surface in them");
    SurfaceInput input;
    input.points = cloud.points;
    input.normals = working_normals(xyz, cloud, options.normals, context);
    in_arena(context, [&] { report.spacing = input.spacing = spacing_of(cloud.points, context); });

    watch.next(method.name);
    context.report(method.name, 0);
    made.mesh = value_or_throw(method.run(input, context));
    context.report(method.name, 1);

    watch.next("clean up");
    in_arena(context, [&] {
      clean_up(made.mesh, input, options, method.closes_all, report, context);
      const auto [row, rank] = row_order(cloud);
      made.row.reserve(made.mesh.positions.size());
      for (const Index p : nearest_points(made.mesh, cloud.points, context)) made.row.push_back(row[rank[p]]);
      for (Eigen::Vector3d& p : made.mesh.positions) p += cloud.origin;
      report.topology = topology(made.mesh.positions.size(), made.mesh.faces);
    });
  }
  if (made.mesh.faces.empty())
    fail(ErrorCode::no_usable_points, "{} finds no surface in these points", method.name);
  return made;
}

}  // namespace

Result<Reconstruction> reconstruct(std::vector<double> xyz, const ReconstructOptions& options,
                                   const SurfaceMethod& method, const Context& context) {
  if (const auto valid = validate(options); !valid.ok()) return valid.error();
  return guarded([&] { return run(std::move(xyz), options, method, context); });
}

}  // namespace rfsmooth
