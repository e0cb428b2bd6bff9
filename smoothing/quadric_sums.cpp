#include "rfsmooth/smoothing/quadric_sums.h"

#include <cstring>

namespace rfsmooth::smoothing {

namespace {

typedef double Doubles __attribute__((vector_size(2 * sizeof(double))));
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));

Doubles doubles(const float* at) {
  return Doubles{double(at[0]), double(at[1])};
}

Floats floats(const float* at) {
  Floats f;
  std::memcpy(&f, at, sizeof f);
  return f;
}

double total(const Doubles& d) {
  return d[0] + d[1];
}

double total(const Floats& f) {
  return (double(f[0]) + double(f[1])) + (double(f[2]) + double(f[3]));
}

/// The moments of degree 0 to 4, in the order 1, u, v, u^2, uv, v^2, u^3, ...
template <class Lanes>
struct Moments {
  Lanes m00 = {}, m10 = {}, m01 = {}, m20 = {}, m11 = {}, m02 = {}, m30 = {}, m21 = {}, m12 = {}, m03 = {},
        m40 = {}, m31 = {}, m22 = {}, m13 = {}, m04 = {};

  void add(const Lanes& u, const Lanes& v, const Lanes& w) {
    const Lanes wu = w * u, wv = w * v, wuu = wu * u, wuv = wu * v, wvv = wv * v, uu = u * u, vv = v * v;
    m00 += w;
    m10 += wu;
    m01 += wv;
    m20 += wuu;
    m11 += wuv;
    m02 += wvv;
    m30 += wuu * u;
    m21 += wuu * v;
    m12 += wvv * u;
    m03 += wvv * v;
    m40 += wuu * uu;
    m31 += wuv * uu;
    m22 += wuu * vv;
    m13 += wuv * vv;
    m04 += wvv * vv;
  }

  Eigen::Matrix<double, 6, 6> matrix() const {
    const double s00 = total(m00), s10 = total(m10), s01 = total(m01), s20 = total(m20), s11 = total(m11),
                 s02 = total(m02), s30 = total(m30), s21 = total(m21), s12 = total(m12), s03 = total(m03),
                 s40 = total(m40), s31 = total(m31), s22 = total(m22), s13 = total(m13), s04 = total(m04);
    Eigen::Matrix<double, 6, 6> m;
    m << s00, s10, s01, s20, s11, s02,  //
        s10, s20, s11, s30, s21, s12,   //
        s01, s11, s02, s21, s12, s03,   //
        s20, s30, s21, s40, s31, s22,   //
        s11, s21, s12, s31, s22, s13,   //
        s02, s12, s03, s22, s13, s04;
    return m;
  }
};

}  // namespace

QuadricSums sum_quadric(std::size_t size, const float* u, const float* v, const float* y, const float* w) {
  Moments<Doubles> moments;
  Doubles y0 = {}, yu = {}, yv = {}, yuu = {}, yuv = {}, yvv = {};
  for (std::size_t k = 0; k < size; k += 2) moments.add(doubles(u + k), doubles(v + k), doubles(w + k));
  for (std::size_t k = 0; k < size; k += 2) {
    const Doubles a = doubles(u + k), b = doubles(v + k), z = doubles(w + k) * doubles(y + k);
    y0 += z;
    yu += z * a;
    yv += z * b;
    yuu += z * a * a;
    yuv += z * a * b;
    yvv += z * b * b;
  }
  QuadricSums sums;
  sums.a = moments.matrix();
  sums.right << total(y0), total(yu), total(yv), total(yuu), total(yuv), total(yvv);
  return sums;
}

Eigen::Matrix<double, 6, 6> sum_squared_weights(std::size_t size, const float* u, const float* v,
                                                const float* w) {
  Moments<Floats> moments;
  for (std::size_t k = 0; k < size; k += kLanes) {
    const Floats weight = floats(w + k);
    moments.add(floats(u + k), floats(v + k), weight * weight);
  }
  return moments.matrix();
}

double sum_residuals(std::size_t size, const float* u, const float* v, const float* y, const float* w,
                     const float* c, const Eigen::Matrix<double, 6, 1>& q) {
  Floats f[6];
  for (int t = 0; t < 6; ++t) f[t] = Floats{} + float(q[t]);
  Floats sum = {};
  for (std::size_t k = 0; k < size; k += kLanes) {
    const Floats a = floats(u + k), b = floats(v + k);
    const Floats height = f[0] + a * (f[1] + a * f[3] + b * f[4]) + b * (f[2] + b * f[5]);
    const Floats e = (floats(y + k) - height) * floats(c + k);
    sum += floats(w + k) * e * e;
  }
  return total(sum);
}

}  // namespace rfsmooth::smoothing
