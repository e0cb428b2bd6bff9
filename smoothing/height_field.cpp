#include "rfsmooth/smoothing/height_field.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::smoothing {

namespace {

constexpr int kNear = 32;           // neighbours over which values are averaged
constexpr std::size_t kPlane = 24;  // neighbours of the plane that gives the normal
constexpr double kSameSheet = 0.5;  // cosine of 60 degrees

Eigen::Vector3d plane_normal(const Positions& points, std::size_t i, rfs_mesh::Adjacency::Row near) {
  const std::size_t count = std::min(near.size(), kPlane);
  // Moments about the point itself: the centre is subtracted afterwards.
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d d = points[near[k]] - points[i];
    sum += d;
    spread += d * d.transpose();
  }
  spread -= sum * sum.transpose() / double(count + 1);
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>()
      .computeDirect(spread)
      .eigenvectors()
      .col(0)
      .normalized();
}

}  // namespace

double same_sheet(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double cosine = a.dot(b);
  return std::abs(cosine) < kSameSheet ? 0 : cosine * cosine;
}

HeightField::HeightField(Positions guide, const Positions& data, const Context& context)
    : guide_(std::move(guide)), index_(guide_, context), near_(index_.nearest(kNear, context)) {
  normals_.resize(size());
  heights_.resize(size());
  for_each_index(context, size(), [&](std::size_t i) {
    normals_[i] = plane_normal(guide_, i, near_[i]);
    if (!normals_[i].allFinite()) normals_[i] = Eigen::Vector3d::UnitZ();
    heights_[i] = normals_[i].dot(data[i] - guide_[i]);
  });
}

std::vector<double> HeightField::local_mean(const std::vector<double>& values, const Context& context) const {
  std::vector<double> mean(values.size());
  for_each_index(context, size(), [&](std::size_t i) {
    const auto row = near_[i];
    const double square =
        row.size() == 0 ? 0 : 1.05 * (guide_[row[row.size() - 1]] - guide_[i]).squaredNorm();
    double sum = values[i], weights = 1;
    for (const Index j : row) {
      if (same_sheet(normals_[i], normals_[j]) == 0) continue;
      const double w = square > 0 ? 1 - (guide_[j] - guide_[i]).squaredNorm() / square : 1;
      sum += w * values[j];
      weights += w;
    }
    mean[i] = sum / weights;
  });
  return mean;
}

}  // namespace rfsmooth::smoothing
