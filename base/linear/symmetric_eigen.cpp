#include "base/linear/symmetric_eigen.h"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace rfsmooth {

SymmetricEigen<2> symmetric_eigen(const Eigen::Matrix2d& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigen<3> symmetric_eigen_closed(const Eigen::Matrix3d& a) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(a);
  const Eigen::Matrix3d& vectors = solver.eigenvectors();
  if (!vectors.allFinite() || std::abs(std::abs(vectors.determinant()) - 1) > 1e-6) return symmetric_eigen(a);
  return {solver.eigenvalues(), vectors};
}

}  // namespace rfsmooth
