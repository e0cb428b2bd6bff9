/// Eigenvalues and eigenvectors of small symmetric matrices. Eigen's solver is compiled here once: each
/// source that makes its own spends half a second of compiling on it (3 x 3) or five seconds (2 x 2). Thread
/// safe.
#pragma once

#include <Eigen/Core>

namespace rfsmooth {

/// The eigenvalues of a symmetric N x N matrix, smallest first, and its eigenvectors, one a column, in the
/// same order. They have length 1 and are orthogonal to each other; which of its two directions each has is
/// left open.
template <int N>
struct SymmetricEigen {
  Eigen::Matrix<double, N, 1> values;
  Eigen::Matrix<double, N, N> vectors;
};

/// By iteration: accurate up to rounding. Reads the lower triangle of `a`; what is not finite comes out not
/// finite.
SymmetricEigen<2> symmetric_eigen(const Eigen::Matrix2d& a);
/// The same of a 3 x 3 matrix.
SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& a);

/// In closed form, which is faster: for frames and normals that need no last digit. It loses accuracy where
/// two eigenvalues nearly meet; eigenvectors that are not orthogonal to 1e-6 are found by iteration instead.
SymmetricEigen<3> symmetric_eigen_closed(const Eigen::Matrix3d& a);

}  // namespace rfsmooth
