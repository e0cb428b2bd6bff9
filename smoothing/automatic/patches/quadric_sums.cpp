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

inline void store(const SumFloats& from, float* at) {
  std::memcpy(at, &from, sizeof from);
}

constexpr std::size_t kPowers[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};  // of u and v

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
double evaluate_quadric(std::size_t size, const float* u, const float* v, const float* y, const float* w,
                        const float* g, const float* c, const Eigen::Matrix<double, 6, 1>& q,
                        const Eigen::Matrix<double, 6, 6>& inverse, const QuadricSays& says) {
  SumFloats f[6], of[5][5] = {}, sum = {}, a, b, e, factor;
  for (int t = 0; t < 6; ++t) f[t] = SumFloats{} + float(q[t]);
  // The coefficient of u^p v^q of f^T inverse f is of[q][p].
  for (int s = 0; s < 6; ++s)
    for (int t = 0; t < 6; ++t)
      of[kPowers[s][1] + kPowers[t][1]][kPowers[s][0] + kPowers[t][0]] += float(inverse(s, t));
  for (std::size_t k = 0; k < size; k += kLanes) {
    load(u + k, a);
    load(v + k, b);
    const SumFloats height = f[0] + a * (f[1] + a * f[3] + b * f[4]) + b * (f[2] + b * f[5]);
    load(c + k, factor);
    load(g + k, e);
    store((height - e) * factor, says.height + k);
    load(y + k, e);
    e = (e - height) * factor;
    load(w + k, factor);
    sum += factor * e * e;
    const SumFloats r0 = of[0][0] + a * (of[0][1] + a * (of[0][2] + a * (of[0][3] + a * of[0][4]))),
                    r1 = of[1][0] + a * (of[1][1] + a * (of[1][2] + a * of[1][3])),
                    r2 = of[2][0] + a * (of[2][1] + a * of[2][2]), r3 = of[3][0] + a * of[3][1];
    store(r0 + b * (r1 + b * (r2 + b * (r3 + b * of[4][0]))), says.influence + k);
  }
  return kTotal(sum);
}

}  // namespace rfsmooth::smoothing
