#include "smoothing/automatic/tails/tails.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"

namespace rfsmooth::smoothing {

namespace {

// Share of the points beyond what noise reaches; white noise on the development shapes leaves at most 0.001.
constexpr double kLeastFar = 0.003;
// s: what lies beyond is a stray and does not say how wide the tails are.
constexpr double kFarthestTail = 12;
constexpr int kTailRounds = 50;

/// Standard deviation of a normal distribution with the same median of absolute values.
double deviation_of(const std::vector<float>& values) {
  constexpr double kMedianOfNormal = 0.6745;
  std::vector<float> absolute;
  for (const float r : values)
    if (!std::isnan(r)) absolute.push_back(std::abs(r));
  return median(absolute.begin(), absolute.end()) / kMedianOfNormal;
}

/// Of the values that are known, those beyond what noise reaches, and no strays.
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

/// Densities of the two parts at t, in units of the narrow one's deviation, over a common factor.
double narrow_density(const Statistics::Tails& tails, double t) {
  return (1 - tails.share) * std::exp(-t * t / 2);
}

double wide_density(const Statistics::Tails& tails, double t) {
  return tails.share / tails.times * std::exp(-t * t / (2 * tails.times * tails.times));
}

}  // namespace

Tails::Tails(const Statistics::Tails& known) : Statistics::Tails(known) {
  if (!(share > 0)) return;
  // The mean over the mixture, by steps that are narrow against its narrower part.
  constexpr double kStep = 0.05, kEnd = 5;
  double sum = 0, all = 0;
  for (double t = kStep / 2; t < kEnd * times; t += kStep) {
    const double density = narrow_density(*this, t) + wide_density(*this, t), psi = t * of_score(t);
    sum += density * psi * psi;
    all += density;
  }
  information_ = sum / all;
}

double Tails::of_score(double t) const {
  const double wide = wide_density(*this, t), close = narrow_density(*this, t);
  const double least = 1 / (times * times);
  return close + wide > 0 ? (close + least * wide) / (close + wide) : least;
}

double Tails::weight(double r) const {
  return share > 0 ? of_score(r / narrow) / information_ : 1;
}

double Tails::noise() const {
  return narrow / std::sqrt(information_);
}

double Tails::normal_score(double r) const {
  if (!(share > 0)) return r;
  // Newton's method on the logarithm of the probability beyond.
  const double t = std::abs(r) / narrow,
               beyond = (1 - share) * std::erfc(t / M_SQRT2) + share * std::erfc(t / (times * M_SQRT2));
  constexpr double kFarthest = 8;
  if (!(beyond > std::erfc(kFarthest / M_SQRT2))) return std::copysign(kFarthest, r);
  double score = std::min(t, kFarthest);
  for (int round = 0; round < 20; ++round) {
    const double here = std::erfc(score / M_SQRT2),
                 slope = std::sqrt(2 / M_PI) * std::exp(-score * score / 2) / here,
                 step = std::log(here / beyond) / slope;
    score += step;
    if (std::abs(step) < 1e-6) break;
  }
  return std::copysign(score, r);
}

double Tails::unit() const {
  return narrow / (1 - share + share / times);
}

Statistics::Tails find_tails(const std::vector<float>& residuals, const std::vector<float>& least) {
  Statistics::Tails tails;
  const double unit = deviation_of(residuals);
  if (!(unit > 0)) return tails;
  // Where many points had to follow themselves, `least` is smaller than the noise, and all of its larger
  // values would be far. The residuals tell how much noise there is, but beside shape more than that.
  const double noise = std::max(deviation_of(least), std::min(1.0, unit));
  if (!(share_of_far(least, noise) > kLeastFar)) return tails;
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
  if (share > kMostInTails) return tails;
  if (wide < rfs_mesh::kLouder * rfs_mesh::kLouder * narrow) return tails;  // noise that varies a little
  tails.share = share;
  tails.times = std::sqrt(wide / narrow);
  tails.narrow = std::min(1.0, std::sqrt(narrow) * unit);
  return tails;
}

}  // namespace rfsmooth::smoothing
