/// The sums of a weighted least-squares fit of z = q.f, f = (1, u, v, u^2, u v, v^2):
///
///     matrix = sum w f f^T,   right = sum w z f
///
/// The matrix holds the moments sum w u^p v^q of degree 0 to 4 only: 15 sums instead of 36.
///
/// `Number` is double, or a SIMD vector whose lanes sum different points; `total` adds the lanes. Internal to
/// the fits. One object per thread.
#pragma once

#include <Eigen/Core>

namespace rfsmooth::rfs_mesh {

/// The matrix.
template <class Number>
class QuadricMoments {
 public:
  void add(const Number& u, const Number& v, const Number& w) {
    const Number wu = w * u, wv = w * v, wuu = wu * u, wuv = wu * v, wvv = wv * v, uu = u * u, vv = v * v;
    m00_ += w;
    m10_ += wu;
    m01_ += wv;
    m20_ += wuu;
    m11_ += wuv;
    m02_ += wvv;
    m30_ += wuu * u;
    m21_ += wuu * v;
    m12_ += wvv * u;
    m03_ += wvv * v;
    m40_ += wuu * uu;
    m31_ += wuv * uu;
    m22_ += wuu * vv;
    m13_ += wuv * vv;
    m04_ += wvv * vv;
  }

  template <class Total>
  Eigen::Matrix<double, 6, 6> matrix(const Total& total) const {
    const double s00 = total(m00_), s10 = total(m10_), s01 = total(m01_), s20 = total(m20_),
                 s11 = total(m11_), s02 = total(m02_), s30 = total(m30_), s21 = total(m21_),
                 s12 = total(m12_), s03 = total(m03_), s40 = total(m40_), s31 = total(m31_),
                 s22 = total(m22_), s13 = total(m13_), s04 = total(m04_);
    Eigen::Matrix<double, 6, 6> m;
    m << s00, s10, s01, s20, s11, s02,  //
        s10, s20, s11, s30, s21, s12,   //
        s01, s11, s02, s21, s12, s03,   //
        s20, s30, s21, s40, s31, s22,   //
        s11, s21, s12, s31, s22, s13,   //
        s02, s12, s03, s22, s13, s04;
    return m;
  }

 private:
  Number m00_ = {}, m10_ = {}, m01_ = {}, m20_ = {}, m11_ = {}, m02_ = {}, m30_ = {}, m21_ = {}, m12_ = {},
         m03_ = {}, m40_ = {}, m31_ = {}, m22_ = {}, m13_ = {}, m04_ = {};
};

/// The right-hand side.
template <class Number>
class QuadricHeights {
 public:
  void add(const Number& u, const Number& v, const Number& wz) {
    const Number zu = wz * u, zv = wz * v;
    m00_ += wz;
    m10_ += zu;
    m01_ += zv;
    m20_ += zu * u;
    m11_ += zu * v;
    m02_ += zv * v;
  }

  template <class Total>
  Eigen::Matrix<double, 6, 1> vector(const Total& total) const {
    Eigen::Matrix<double, 6, 1> r;
    r << total(m00_), total(m10_), total(m01_), total(m20_), total(m11_), total(m02_);
    return r;
  }

 private:
  Number m00_ = {}, m10_ = {}, m01_ = {}, m20_ = {}, m11_ = {}, m02_ = {};
};

}  // namespace rfsmooth::rfs_mesh
