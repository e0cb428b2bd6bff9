#include "smoothing/automatic/patches/tails.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "rfs_mesh/levels.h"

namespace rfsmooth::smoothing {

namespace {

// Share of the points beyond what noise reaches; white noise on the development shapes leaves at most 0.001.
constexpr double kLeastFar = 0.003;
// s: what lies beyond is a stray and does not say how wide the tails are.
constexpr double kFarthestTail = 12;
constexpr double kMostInTails = 0.35;  // more is noise that differs over the cloud
constexpr double kTwice = 2.1;         // least `times`: less is a scale that varies a little
constexpr int kTailRounds = 50;

/// Standard deviation of a normal distribution with the same median of absolute values.
double scale(const std::vector<float>& values) {
  constexpr double kMedianOfNormal = 0.6745;
  std::vector<float> absolute;
  for (const float r : values)
    if (!std::isnan(r)) absolute.push_back(std::abs(r));
  if (absolute.empty()) return 0;
  const auto middle = absolute.begin() + std::ptrdiff_t(absolute.size() / 2);
  std::nth_element(absolute.begin(), middle, absolute.end());
  return double(*middle) / kMedianOfNormal;
}

double share_of_far(const std::vector<float>& values, double unit) {
  const auto far = std::count_if(values.begin(), values.end(), [&](float r) {
    return double(std::abs(r)) > rfs_mesh::kNoiseReach * unit && double(std::abs(r)) < kFarthestTail * unit;
  });
  const auto known = std::count_if(values.begin(), values.end(), [](float r) { return !std::isnan(r); });
  return known > 0 ? double(far) / double(known) : 0;
}

/// How many of the values, in units, have each square: mean squares of bins that are narrow against any
/// normal distribution, so that its parts are found in time that does not depend on n.
struct Squares {
  static constexpr std::size_t kBins = 1200;
  std::array<double, kBins> count = {}, square = {};

  Squares(const std::vector<float>& values, double unit) {
    for (const float r : values) {
      const double t = double(std::abs(r)) / unit;
      if (!(t < kFarthestTail)) continue;
      const auto bin = std::min(kBins - 1, std::size_t(t / kFarthestTail * kBins));
      count[bin] += 1;
      square[bin] += t * t;
    }
    for (std::size_t b = 0; b < kBins; ++b)
      if (count[b] > 0) square[b] /= count[b];
  }
};

}  // namespace

double Tails::weight(double r) const {
  if (!(share > 0)) return 1;
  const double t = r / narrow;
  const double wide = share / times * std::exp(-t * t / (2 * times * times));
  const double close = (1 - share) * std::exp(-t * t / 2);
  const double least = 1 / (times * times);
  return close + wide > 0 ? (close + least * wide) / (close + wide) : least;
}

Tails find_tails(const std::vector<float>& residuals, const std::vector<float>& least) {
  Tails tails;
  if (residuals.empty() || !(share_of_far(least, scale(least)) > kLeastFar)) return tails;
  const double unit = scale(residuals);
  if (!(unit > 0)) return tails;
  const Squares squares(residuals, unit);
  double share = 0.1, narrow = 1, wide = 9;
  for (int round = 0; round < kTailRounds; ++round) {
    double sums[2] = {}, weights[2] = {};
    for (std::size_t bin = 0; bin < Squares::kBins; ++bin) {
      const double count = squares.count[bin], square = squares.square[bin];
      const double a = (1 - share) / std::sqrt(narrow) * std::exp(-square / (2 * narrow)),
                   b = share / std::sqrt(wide) * std::exp(-square / (2 * wide)), is_wide = b / (a + b);
      sums[0] += count * (1 - is_wide) * square;
      sums[1] += count * is_wide * square;
      weights[0] += count * (1 - is_wide);
      weights[1] += count * is_wide;
    }
    share = weights[1] / (weights[0] + weights[1]);
    narrow = sums[0] / weights[0];
    wide = sums[1] / weights[1];
  }
  if (share > kMostInTails || wide < kTwice * kTwice * narrow) return tails;
  tails.share = share;
  tails.times = std::sqrt(wide / narrow);
  tails.narrow = std::min(1.0, std::sqrt(narrow) * unit);
  return tails;
}

}  // namespace rfsmooth::smoothing
