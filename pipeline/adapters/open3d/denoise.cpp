#include <Eigen/Geometry>
#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>

#include <rfsmooth/normals.h>
#include <rfsmooth/open3d/denoise.h>

#include "base/linear/symmetric_eigen.h"
#include "base/parallel.h"
#include "pipeline/normals/normal_sides.h"
#include "rfs_mesh/points.h"

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
  value_or_throw(rfsmooth::estimate_normals(xyz, n, {}, context, normals.front().data()));
  if (before == nullptr) return normals;
  pipeline::keep_sides(xyz, n, before->front().data(), normals.front().data(), context);
  for (std::size_t i = 0; i < n; ++i)
    if (!points[i].allFinite()) normals[i] = (*before)[i];
  return normals;
}

/// Turns each covariance so that its axis of least spread lies along the normal, by the shorter way.
void turn(Matrices& covariances, const Positions& points, const Positions& normals, const Context& context) {
  for_each_index(context, covariances.size(), [&](std::size_t i) {
    Eigen::Matrix3d& c = covariances[i];
    if (!points[i].allFinite() || !c.allFinite()) return;
    const Eigen::Vector3d least = symmetric_eigen(c).vectors.col(0);
    const Eigen::Vector3d onto = least.dot(normals[i]) < 0 ? Eigen::Vector3d(-normals[i]) : normals[i];
    const Eigen::Matrix3d rotation = Eigen::Quaterniond::FromTwoVectors(least, onto).toRotationMatrix();
    c = rotation * c * rotation.transpose();
  });
}

/// Open3D's own, of the finite points only: its search is not made for others.
void estimate(Matrices& covariances, const Positions& points) {
  PointCloud finite;
  std::vector<std::size_t> row;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    finite.points_.push_back(points[i]);
    row.push_back(i);
  }
  finite.EstimateCovariances();
  for (std::size_t k = 0; k < row.size(); ++k) covariances[row[k]] = finite.covariances_[k];
}

/// Closes an array that is one per point up over the points that go.
template <class T, class Allocator>
void close_up(std::vector<T, Allocator>& rows, const std::vector<char>& gone) {
  if (rows.size() != gone.size()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (gone[i] == 0) rows[kept++] = rows[i];
  rows.resize(kept);
}

DenoiseReport run(PointCloud& cloud, const DenoiseOptions& options, const Context& context,
                  Covariances kind) {
  PointCloud made = cloud;
  const std::size_t n = made.points_.size();
  const DenoiseReport done =
      value_or_throw(rfsmooth::denoise(n == 0 ? nullptr : made.points_.front().data(), n, options, context));
  const bool removes = options.outliers == Outliers::remove && done.outliers > 0;
  if (done.moved == 0 && !removes) return done;
  if (removes) {
    close_up(made.normals_, done.outlier);
    close_up(made.colors_, done.outlier);
    close_up(made.covariances_, done.outlier);
    close_up(made.points_, done.outlier);
  }

  const bool turns = made.HasCovariances() && kind == Covariances::turned;
  if (made.HasNormals() || turns) {
    context.report("normals", 0);
    Positions normals = surface_normals(made.points_, made.HasNormals() ? &made.normals_ : nullptr, context);
    if (turns) turn(made.covariances_, made.points_, normals, context);
    if (made.HasNormals()) made.normals_ = std::move(normals);
  }
  if (made.HasCovariances() && !turns) estimate(made.covariances_, made.points_);
  context.check_stop();

  // Nothing below can fail.
  cloud.points_.swap(made.points_);
  cloud.normals_.swap(made.normals_);
  cloud.colors_.swap(made.colors_);
  cloud.covariances_.swap(made.covariances_);
  return done;
}

}  // namespace

Result<DenoiseReport> denoise(PointCloud& cloud, const DenoiseOptions& options, const Context& context,
                              Covariances covariances) {
  return guarded([&] {
    DenoiseReport report;
    in_arena(context, [&] { report = run(cloud, options, context, covariances); });
    return report;
  });
}

}  // namespace rfsmooth::open3d
