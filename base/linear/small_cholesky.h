/// Cholesky factorisation of small positive definite matrices. The size is a compile-time constant, so that
/// the loops are unrolled: 0.7 of the time of Eigen::LLT (kernels_bench). Const functions are thread safe.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace rfsmooth {

/// The factor L of L L^T = a. If a is not positive definite, the results are not finite.
template <int N>
class SmallCholesky {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  /// Reads the lower triangle of `a`.
  explicit SmallCholesky(const Matrix& a) {
    for (int j = 0; j < N; ++j) {
      double square = a(j, j);
      for (int k = 0; k < j; ++k) square -= l_[j][k] * l_[j][k];
      per_[j] = 1 / std::sqrt(square);
      for (int i = j + 1; i < N; ++i) {
        double sum = a(i, j);
        for (int k = 0; k < j; ++k) sum -= l_[i][k] * l_[j][k];
        l_[i][j] = sum * per_[j];
      }
    }
  }

  /// a^-1 b
  Vector solve(const Vector& b) const {
    Vector x;
    for (int i = 0; i < N; ++i) {
      double sum = b[i];
      for (int k = 0; k < i; ++k) sum -= l_[i][k] * x[k];
      x[i] = sum * per_[i];
    }
    for (int i = N; i-- > 0;) {
      double sum = x[i];
      for (int k = i + 1; k < N; ++k) sum -= l_[k][i] * x[k];
      x[i] = sum * per_[i];
    }
    return x;
  }

  /// L^-1, lower: |L^-1 f|^2 = f^T a^-1 f, without loss of digits where a is nearly singular
  Matrix inverse_factor() const {
    Matrix m = Matrix::Zero();
    for (int j = 0; j < N; ++j) {
      m(j, j) = per_[j];
      for (int i = j + 1; i < N; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) sum -= l_[i][k] * m(k, j);
        m(i, j) = sum * per_[i];
      }
    }
    return m;
  }

  /// a^-1 = L^-T L^-1
  Matrix inverse() const {
    const Matrix m = inverse_factor();
    Matrix inverse;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j <= i; ++j) {
        double sum = 0;
        for (int k = i; k < N; ++k) sum += m(k, i) * m(k, j);
        inverse(i, j) = inverse(j, i) = sum;
      }
    return inverse;
  }

 private:
  double l_[N][N], per_[N];  // L below its diagonal; 1 / the diagonal
};

}  // namespace rfsmooth
