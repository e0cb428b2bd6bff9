/// The weighted sum of values picked out of an array, several at a time. Thread safe.
#pragma once

#include <cstddef>
#include <cstring>

#include "rfs_mesh/points.h"

namespace rfsmooth::smoothing {

/// sum w_k v_k and sum w_k.
struct WeightedSum {
  float sum = 0, weights = 0;
};

/// Over v = values[picked[k]], k in [0, size); `weight`: small whole numbers. Four sums side by side: one
/// after the other, each addition would wait for the one before. O(size), the same bits every time.
template <class Weight>
WeightedSum weighted_sum(std::size_t size, const Index* picked, const Weight* weight, const float* values) {
  typedef float Floats __attribute__((vector_size(4 * sizeof(float))));
  typedef Weight Weights __attribute__((vector_size(4 * sizeof(Weight))));
  Floats sum = {}, weights = {};
  std::size_t k = 0;
  for (; k + 4 <= size; k += 4) {
    const Floats v = {values[picked[k]], values[picked[k + 1]], values[picked[k + 2]], values[picked[k + 3]]};
    Weights whole;
    std::memcpy(&whole, weight + k, sizeof whole);
    const Floats w = __builtin_convertvector(whole, Floats);
    sum += w * v;
    weights += w;
  }
  WeightedSum all{(sum[0] + sum[1]) + (sum[2] + sum[3]),
                  (weights[0] + weights[1]) + (weights[2] + weights[3])};
  for (; k < size; ++k) {
    all.sum += float(weight[k]) * values[picked[k]];
    all.weights += float(weight[k]);
  }
  return all;
}

}  // namespace rfsmooth::smoothing
