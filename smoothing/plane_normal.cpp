#include "rfsmooth/smoothing/plane_normal.h"

#include <Eigen/Eigenvalues>

namespace rfsmooth::smoothing {

Eigen::Vector3d plane_normal(const Positions& points, std::size_t i, rfs_mesh::Adjacency::Row near) {
  // Moments about the point itself: the centre is subtracted afterwards.
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Index j : near) {
    const Eigen::Vector3d d = points[j] - points[i];
    sum += d;
    spread += d * d.transpose();
  }
  spread -= sum * sum.transpose() / double(near.size() + 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>().computeDirect(spread);
  return solver.eigenvectors().col(0).normalized();
}

}  // namespace rfsmooth::smoothing
