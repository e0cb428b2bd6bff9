#include "smoothing/automatic/patches/quadric_sums.h"

#include <cstring>

#include "base/avx2.h"
#include "rfs_mesh/fit/quadric_moments.h"

namespace rfsmooth::smoothing {

namespace {

constexpr std::size_t kDoubles = kLanes / 2;  // side by side
typedef double Doubles __attribute__((vector_size(kDoubles * sizeof(double))));
typedef float Halves __attribute__((vector_size(kDoubles * sizeof(float))));
typedef float SumFloats __attribute__((vector_size(kLanes * sizeof(float))));

inline void load(const float* at, Doubles& to) {
  Halves f;
  std::memcpy(&f, at, sizeof f);
  to = __builtin_convertvector(f, Doubles);
}

inline void load(const float* at, SumFloats& to) {
  std::memcpy(&to, at, sizeof to);
}

const auto kTotal = [](const auto& lanes) {
  double sum = 0;
  for (std::size_t k = 0; k < sizeof lanes / sizeof lanes[0]; ++k) sum += double(lanes[k]);
  return sum;
};

}  // namespace

RFSMOOTH_AVX2
void sum_quadric(std::size_t size, const float* u, const float* v, const float* y, const float* w,
                 QuadricSums& sums) {
  rfs_mesh::QuadricMoments<Doubles> moments;
  Doubles a, b, c, d;
  for (std::size_t k = 0; k < size; k += kDoubles) {
    load(u + k, a);
    load(v + k, b);
    load(w + k, c);
    moments.add(a, b, c);
  }
  rfs_mesh::QuadricHeights<Doubles> heights;
  for (std::size_t k = 0; k < size; k += kDoubles) {
    load(u + k, a);
    load(v + k, b);
    load(w + k, c);
    load(y + k, d);
    d *= c;
    heights.add(a, b, d);
  }
  sums.a = moments.matrix(kTotal);
  sums.right = heights.vector(kTotal);
}

RFSMOOTH_AVX2
void sum_squared_weights(std::size_t size, const float* u, const float* v, const float* w,
                         Eigen::Matrix<double, 6, 6>& sums) {
  rfs_mesh::QuadricMoments<SumFloats> moments;
  SumFloats a, b, c;
  for (std::size_t k = 0; k < size; k += kLanes) {
    load(u + k, a);
    load(v + k, b);
    load(w + k, c);
    c *= c;
    moments.add(a, b, c);
  }
  sums = moments.matrix(kTotal);
}

RFSMOOTH_AVX2
double sum_residuals(std::size_t size, const float* u, const float* v, const float* y, const float* w,
                     const float* c, const Eigen::Matrix<double, 6, 1>& q) {
  SumFloats f[6], sum = {}, a, b, e, factor;
  for (int t = 0; t < 6; ++t) f[t] = SumFloats{} + float(q[t]);
  for (std::size_t k = 0; k < size; k += kLanes) {
    load(u + k, a);
    load(v + k, b);
    load(y + k, e);
    e -= f[0] + a * (f[1] + a * f[3] + b * f[4]) + b * (f[2] + b * f[5]);
    load(c + k, factor);
    e *= factor;
    load(w + k, factor);
    sum += factor * e * e;
  }
  return kTotal(sum);
}

}  // namespace rfsmooth::smoothing
