/// A point's surroundings as they are seen from where the smoother put it, and their sums: heights of the
/// data in bins, moments of the data, of residuals and of the smoothed points. All lengths in s (features.h);
/// points in a disc or ball of radius r weigh (1 - d^2 / r^2)^2.
///
/// This is what the learned step spends its time on, hence columns and lanes: loops over them compile to
/// vector instructions, and lanes are added up in the same order on every processor.
#pragma once

#include <array>
#include <cstddef>

#include "smoothing/automatic/learned/surroundings.h"

namespace rfsmooth::smoothing {

constexpr double kSeen = 6.5;               // s: the ball around the guide
constexpr float kInner = 3, kOuter = 6;     // s: discs of heights, balls of residuals
constexpr float kAround = 5, kMoments = 6;  // s: balls of smoothed points and of moments
constexpr std::size_t kSide = 6;            // bins on either side
constexpr float kBin = 0.75F;               // s

/// A point, from where its surroundings are seen.
struct Here {
  std::array<float, 3> shift, from;  ///< of the guides; from its guide to P; world units
  std::array<float, 3> normal;
  float per_unit, radius;  ///< 1 / s; of the ball, world units
};

/// Heights of points in bins, each shared by the two nearest, and the weights of all, lane by lane.
struct Histogram {
  std::array<float, 2 * kSide + 1> bin{};
  float all[Surroundings::kLanes] = {};
};

/// The sum over lanes.
inline float total(const float (&lane)[Surroundings::kLanes]) {
  float sum = 0;
  for (const float x : lane) sum += x;
  return sum;
}

/// Weighted sums of N numbers, and of the weights, lane by lane.
template <std::size_t N>
struct Sums {
  static constexpr std::size_t kLanes = Surroundings::kLanes;
  float all[kLanes] = {};
  float sum[N][kLanes] = {};

  /// The means.
  std::array<float, N> means() const {
    const float unit = 1 / (total(all) + 1e-6F);
    std::array<float, N> mean;
    for (std::size_t k = 0; k < N; ++k) mean[k] = unit * total(sum[k]);
    return mean;
  }
};

/// What is seen.
struct Seen {
  Histogram inner, outer;  ///< heights of the data over the discs
  /// Of the smoothed points: height, its square, how they face (along, against, either); height of those that
  /// face along, of those against.
  Sums<7> sheets;
  Sums<9> moments;      ///< of the data: x, y, z, xx, yy, zz, xy, xz, yz, world axes
  Sums<4> close, wide;  ///< r, r^2, r^3, r^4 within kInner and within kOuter
};

/// O(around.size()).
void see(const Surroundings& around, const Here& here, Seen& seen);

}  // namespace rfsmooth::smoothing
