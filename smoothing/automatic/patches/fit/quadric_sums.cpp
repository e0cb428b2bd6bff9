#include "smoothing/automatic/patches/fit/quadric_sums.h"

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
QuadricErrors evaluate_quadric(std::size_t size, const float* u, const float* v, const float* y,
                               const float* w, const float* g, const float* c,
                               const Eigen::Matrix<double, 6, 1>& q, const Eigen::Matrix<double, 6, 6>& half,
                               const QuadricSays& says) {
  float l[6][6], coefficient[6];
  for (int s = 0; s < 6; ++s) {
    coefficient[s] = float(q[s]);
    for (int t = 0; t < 6; ++t) l[s][t] = float(half(s, t));
  }
  const SumFloats one = SumFloats{} + 1.0F;
  SumFloats residuals = {}, leverage = {}, a, b, at, weight, cosine;
  for (std::size_t k = 0; k < size; k += kLanes) {
    load(u + k, a);
    load(v + k, b);
    load(w + k, weight);
    load(c + k, cosine);
    const SumFloats f[6] = {one, a, b, a * a, a * b, b * b};
    SumFloats height = {}, influence = {};
    for (int s = 0; s < 6; ++s) {
      height += coefficient[s] * f[s];
      SumFloats part = l[s][0] * f[0];
      for (int t = 1; t <= s; ++t) part += l[s][t] * f[t];
      influence += part * part;
    }
    store(influence, says.influence + k);
    leverage += weight * weight * influence;
    load(g + k, at);
    store((height - at) * cosine, says.height + k);
    load(y + k, at);
    at = (at - height) * cosine;
    residuals += weight * at * at;
  }
  return {kTotal(residuals), kTotal(leverage)};
}

}  // namespace rfsmooth::smoothing
