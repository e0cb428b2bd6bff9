/// What weights.cpp holds. Made by tests/bench/train, not by hand.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rfsmooth::smoothing::learned {

/// Of the features and their order, the network and the table: to be raised when any of them changes. Weights
/// that were made for another one do not compile.
inline constexpr int kFormat = 2;

inline constexpr std::size_t kInputs = 81;                ///< features, even and odd
inline constexpr std::size_t kFirst = 128, kSecond = 48;  ///< units of the two layers

/// Whole numbers times a unit of their row.
extern const float kCentre[kInputs], kScale[kInputs];  ///< of the features, even ones first
extern const std::int16_t kFirstWeight[kInputs * kFirst], kSecondWeight[kFirst * kSecond],
    kLastWeight[kSecond];
extern const float kFirstUnit[kInputs], kSecondUnit[kFirst], kLastUnit;
extern const float kFirstBias[kFirst], kSecondBias[kSecond];

}  // namespace rfsmooth::smoothing::learned
