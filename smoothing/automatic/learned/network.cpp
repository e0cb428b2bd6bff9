#include "smoothing/automatic/learned/network.h"

#include <algorithm>

#include "base/avx2.h"

namespace rfsmooth::smoothing {

namespace {

using learned::kFirst;
using learned::kSecond;

constexpr float kFarInput = 6, kLeak = 0.1F;

inline float leaky(float t) {
  return std::max(t, kLeak * t);
}

template <std::size_t N>
inline void add_times(float x, const std::array<float, N>& row, std::array<float, N>& sum) {
  for (std::size_t k = 0; k < N; ++k) sum[k] += x * row[k];
}

/// A row of the whole numbers in a table.
template <std::size_t N>
void unpack(const std::int16_t* from, float unit, std::array<float, N>& row) {
  for (std::size_t k = 0; k < N; ++k) row[k] = unit * float(from[k]);
}

inline float scaled_input(std::size_t k, float x) {
  return std::clamp((x - learned::kCentre[k]) * learned::kScale[k], -kFarInput, kFarInput);
}

}  // namespace

Network::Network() {
  for (std::size_t k = 0; k < kInputs; ++k)
    unpack(learned::kFirstWeight + k * kFirst, learned::kFirstUnit[k], first_[k]);
  for (std::size_t k = 0; k < kFirst; ++k)
    unpack(learned::kSecondWeight + k * kSecond, learned::kSecondUnit[k], second_[k]);
  unpack(learned::kLastWeight, learned::kLastUnit, last_);
}

RFSMOOTH_AVX2
float Network::behind(const First& first) const {
  Second second;
  std::copy(learned::kSecondBias, learned::kSecondBias + kSecond, second.begin());
  for (std::size_t k = 0; k < kFirst; ++k) add_times(leaky(first[k]), second_[k], second);
  float y = 0;
  for (std::size_t k = 0; k < kSecond; ++k) y += last_[k] * leaky(second[k]);
  return y;
}

RFSMOOTH_AVX2
void Network::through_first(const Features::Row& row, First& one, First& other) const {
  First odd{};
  std::copy(learned::kFirstBias, learned::kFirstBias + kFirst, one.begin());
  for (std::size_t k = 0; k < Features::kEven; ++k) add_times(scaled_input(k, row.even[k]), first_[k], one);
  for (std::size_t k = 0; k < Features::kOdd; ++k)
    add_times(scaled_input(Features::kEven + k, row.odd[k]), first_[Features::kEven + k], odd);
  for (std::size_t k = 0; k < kFirst; ++k) {
    other[k] = one[k] - odd[k];
    one[k] += odd[k];
  }
}

float Network::offset(const Features::Row& row) const {
  First one, other;
  through_first(row, one, other);
  return 0.5F * (behind(one) - behind(other));
}

}  // namespace rfsmooth::smoothing
