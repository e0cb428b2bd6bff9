#include "rfsmooth/smoothing/quadric_sums.h"

#include <cstring>

#include "rfsmooth/rfs_mesh/quadric_moments.h"

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

const auto kTotal = [](const auto& lanes) { return total(lanes); };

}  // namespace

QuadricSums sum_quadric(std::size_t size, const float* u, const float* v, const float* y, const float* w) {
  rfs_mesh::QuadricMoments<Doubles> moments;
  for (std::size_t k = 0; k < size; k += 2) moments.add(doubles(u + k), doubles(v + k), doubles(w + k));
  rfs_mesh::QuadricHeights<Doubles> heights;
  for (std::size_t k = 0; k < size; k += 2)
    heights.add(doubles(u + k), doubles(v + k), doubles(w + k) * doubles(y + k));
  QuadricSums sums;
  sums.a = moments.matrix(kTotal);
  sums.right = heights.vector(kTotal);
  return sums;
}

Eigen::Matrix<double, 6, 6> sum_squared_weights(std::size_t size, const float* u, const float* v,
                                                const float* w) {
  rfs_mesh::QuadricMoments<Floats> moments;
  for (std::size_t k = 0; k < size; k += kLanes) {
    const Floats weight = floats(w + k);
    moments.add(floats(u + k), floats(v + k), weight * weight);
  }
  return moments.matrix(kTotal);
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
