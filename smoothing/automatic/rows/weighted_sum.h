/// The weighted sums of values picked out of arrays, several at a time. Thread safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>

#include "rfs_mesh/points.h"

namespace rfsmooth::smoothing {

/// sum w_k v_k of each of several arrays, and sum w_k.
template <std::size_t kCount>
struct WeightedSums {
  std::array<float, kCount> sum = {};
  float weights = 0;
};

/// Over v = values[picked[k]], k in [0, size), of each array; `weight`: small whole numbers. Four sums side
/// by side: one after the other, each addition would wait for the one before. O(size), the same bits every
/// time and for any number of arrays.
template <class Weight, std::size_t kCount>
WeightedSums<kCount> weighted_sums(std::size_t size, const Index* picked, const Weight* weight,
                                   const std::array<const float*, kCount>& values) {
  typedef float Floats __attribute__((vector_size(4 * sizeof(float))));
  typedef Weight Weights __attribute__((vector_size(4 * sizeof(Weight))));
  Floats sum[kCount] = {}, weights = {};
  std::size_t k = 0;
  for (; k + 4 <= size; k += 4) {
    Weights whole;
    std::memcpy(&whole, weight + k, sizeof whole);
    const Floats w = __builtin_convertvector(whole, Floats);
    for (std::size_t c = 0; c < kCount; ++c) {
      const float* const from = values[c];
      sum[c] += w * Floats{from[picked[k]], from[picked[k + 1]], from[picked[k + 2]], from[picked[k + 3]]};
    }
    weights += w;
  }
  WeightedSums<kCount> all;
  for (std::size_t c = 0; c < kCount; ++c) all.sum[c] = (sum[c][0] + sum[c][1]) + (sum[c][2] + sum[c][3]);
  all.weights = (weights[0] + weights[1]) + (weights[2] + weights[3]);
  for (; k < size; ++k) {
    for (std::size_t c = 0; c < kCount; ++c) all.sum[c] += float(weight[k]) * values[c][picked[k]];
    all.weights += float(weight[k]);
  }
  return all;
}

}  // namespace rfsmooth::smoothing
