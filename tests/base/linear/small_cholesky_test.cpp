#include "base/linear/small_cholesky.h"

#include <cmath>

#include <gtest/gtest.h>

using rfsmooth::SmallCholesky;

namespace {

TEST(SmallCholesky, SolvesAndInverts) {
  using Matrix = Eigen::Matrix<double, 6, 6>;
  using Vector = Eigen::Matrix<double, 6, 1>;
  Matrix root;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) root(i, j) = std::sin(3.0 * i + 7.0 * j * j);
  const Matrix a = root * root.transpose() + 0.1 * Matrix::Identity();
  const Vector x = Vector::LinSpaced(-2, 3);
  const SmallCholesky<6> cholesky(a);
  EXPECT_LT((cholesky.solve(a * x) - x).norm(), 1e-10);
  EXPECT_LT((cholesky.inverse() * a - Matrix::Identity()).norm(), 1e-10);
  EXPECT_EQ(cholesky.inverse(), cholesky.inverse().transpose());
}

TEST(SmallCholesky, WhatIsNotPositiveDefiniteComesOutNotFinite) {
  Eigen::Matrix2d a;
  a << 1, 2, 2, 1;
  EXPECT_FALSE(SmallCholesky<2>(a).solve(Eigen::Vector2d(1, 1)).allFinite());
}

}  // namespace
