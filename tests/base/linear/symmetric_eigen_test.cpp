#include "base/linear/symmetric_eigen.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

using Eigen::Matrix3d;
using Eigen::Vector3d;
using rfsmooth::SymmetricEigen;

namespace {

/// Whether `eigen` takes `a` apart, to `least` of its largest eigenvalue.
template <int N>
void expect_decomposes(const Eigen::Matrix<double, N, N>& a, const SymmetricEigen<N>& eigen, double least) {
  const auto& [values, vectors] = eigen;
  const double largest = values.cwiseAbs().maxCoeff();
  EXPECT_LE((vectors.transpose() * vectors - Eigen::Matrix<double, N, N>::Identity()).norm(), least);
  EXPECT_LE((a * vectors - vectors * values.asDiagonal()).norm(), least * largest);
  for (int i = 1; i < N; ++i) EXPECT_LE(values[i - 1], values[i] + least * largest);
}

/// Matrices of the given eigenvalues, variously turned.
std::vector<Matrix3d> turned(const Vector3d& values) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<Matrix3d> all = {values.asDiagonal()};
  while (all.size() < 50) {
    const Matrix3d frame = Eigen::Quaterniond(any(random), any(random), any(random), any(random))
                               .normalized()
                               .toRotationMatrix();
    all.push_back(frame * values.asDiagonal() * frame.transpose());
  }
  return all;
}

TEST(SymmetricEigen, TakesAMatrixApart) {
  for (const Vector3d& values :
       {Vector3d(1, 2, 3), Vector3d(-5, 0, 5), Vector3d(1e-8, 1, 1), Vector3d(1, 1, 1), Vector3d(0, 0, 1),
        Vector3d(0, 0, 0), Vector3d(1e-200, 2e-200, 5e-200)})
    for (const Matrix3d& a : turned(values)) {
      SCOPED_TRACE(a);
      expect_decomposes(a, rfsmooth::symmetric_eigen(a), 1e-14);
      EXPECT_LE((rfsmooth::symmetric_eigen(a).values - values).norm(), 1e-14 * values.norm());
    }
}

TEST(SymmetricEigen, TheClosedFormDoes) {
  for (const Vector3d& values :
       {Vector3d(1, 2, 3), Vector3d(-5, 0, 5), Vector3d(1e-8, 1, 2), Vector3d(1, 1, 1)})
    for (const Matrix3d& a : turned(values)) {
      SCOPED_TRACE(a);
      expect_decomposes(a, rfsmooth::symmetric_eigen_closed(a), 1e-6);
    }
}

TEST(SymmetricEigen, TheClosedFormsAxesAreAFrameWhereTwoEigenvaluesMeet) {
  for (const double gap : {0.0, 1e-16, 1e-14, 1e-12, 1e-10, 1e-8})
    for (const Matrix3d& a : turned(Vector3d(1, 1 + gap, 2))) {
      SCOPED_TRACE(a);
      const Matrix3d axes = rfsmooth::symmetric_eigen_closed(a).vectors;
      EXPECT_NEAR(std::abs(axes.determinant()), 1, 1e-6);
    }
}

TEST(SymmetricEigen, OfTheLowerTriangleInTwoDimensionsToo) {
  for (int i = 0; i < 20; ++i) {
    Eigen::Matrix2d a;
    a << std::cos(i), std::sin(3.0 * i), std::sin(3.0 * i), std::cos(5.0 * i);
    expect_decomposes(a, rfsmooth::symmetric_eigen(a), 1e-14);
    Eigen::Matrix2d lower = a;
    lower(0, 1) = 7;
    EXPECT_EQ(rfsmooth::symmetric_eigen(lower).vectors, rfsmooth::symmetric_eigen(a).vectors);
  }
}

TEST(SymmetricEigen, WhatIsNotFiniteComesOutNotFinite) {
  const Matrix3d a = Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(rfsmooth::symmetric_eigen(a).vectors.allFinite());
  EXPECT_FALSE(rfsmooth::symmetric_eigen_closed(a).vectors.allFinite());
}

}  // namespace
