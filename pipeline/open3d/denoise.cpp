#include "rfsmooth/open3d/denoise.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>

#include "rfsmooth/pipeline/normal_sides.h"
#include "rfsmooth/pipeline/normals.h"
#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/rfs_mesh/points.h"

namespace rfsmooth::open3d {

namespace {

using ::open3d::geometry::PointCloud;
using Matrices = std::vector<Eigen::Matrix3d>;

/// A unit normal of the surface through the points for each finite row, on the side of `before` if there is
/// one; rows that are not finite keep theirs.
Positions surface_normals(const Positions& points, const Positions* before, const Context& context) {
  const std::size_t n = points.size();
  const double* const xyz = points.front().data();
  Positions normals(n);
  const auto done = pipeline::estimate_normals(xyz, n, {}, context, normals.front().data());
  if (!done.ok()) throw Failure(done.error());
  if (before == nullptr) return normals;
  pipeline::keep_sides(xyz, n, before->front().data(), normals.front().data(), context);
  for (std::size_t i = 0; i < n; ++i)
    if (!points[i].allFinite()) normals[i] = (*before)[i];
  return normals;
}

/// Each covariance turned so that its axis of least spread lies along the normal, by the shorter way.
Matrices turned(const Matrices& covariances, const Positions& points, const Positions& normals,
                const Context& context) {
  Matrices out = covariances;
  for_each_index(context, out.size(), [&](std::size_t i) {
    if (!points[i].allFinite() || !out[i].allFinite()) return;
    const Eigen::Vector3d least =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(out[i]).eigenvectors().col(0);
    const Eigen::Vector3d onto = least.dot(normals[i]) < 0 ? Eigen::Vector3d(-normals[i]) : normals[i];
    const Eigen::Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(least, onto).toRotationMatrix();
    out[i] = turn * out[i] * turn.transpose();
  });
  return out;
}

/// Open3D's own, of the finite points only: its search is not made for others.
Matrices estimated(const Matrices& covariances, const Positions& points) {
  PointCloud finite;
  std::vector<std::size_t> row;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    finite.points_.push_back(points[i]);
    row.push_back(i);
  }
  finite.EstimateCovariances();
  Matrices out = covariances;
  for (std::size_t k = 0; k < row.size(); ++k) out[row[k]] = finite.covariances_[k];
  return out;
}

pipeline::DenoiseReport run(PointCloud& cloud, const pipeline::DenoiseOptions& options,
                            const Context& context, Covariances kind) {
  Positions points = cloud.points_;
  auto done =
      pipeline::denoise(points.empty() ? nullptr : points.front().data(), points.size(), options, context);
  if (!done.ok()) throw Failure(done.error());
  if (done.value().moved == 0) return std::move(done).value();

  Positions normals;
  Matrices covariances;
  const bool turns = cloud.HasCovariances() && kind == Covariances::turned;
  if (cloud.HasNormals() || turns) {
    context.report("normals", 0);
    normals = surface_normals(points, cloud.HasNormals() ? &cloud.normals_ : nullptr, context);
  }
  if (turns)
    covariances = turned(cloud.covariances_, points, normals, context);
  else if (cloud.HasCovariances())
    covariances = estimated(cloud.covariances_, points);
  context.check_stop();

  // Nothing below can fail.
  cloud.points_.swap(points);
  if (cloud.HasNormals()) cloud.normals_.swap(normals);
  if (cloud.HasCovariances()) cloud.covariances_.swap(covariances);
  return std::move(done).value();
}

}  // namespace

Result<pipeline::DenoiseReport> denoise(PointCloud& cloud, const pipeline::DenoiseOptions& options,
                                        const Context& context, Covariances covariances) {
  return guarded([&] {
    pipeline::DenoiseReport report;
    in_arena(context, [&] { report = run(cloud, options, context, covariances); });
    return report;
  });
}

}  // namespace rfsmooth::open3d
