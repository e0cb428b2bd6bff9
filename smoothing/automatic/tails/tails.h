/// Points that are several times noisier than their neighbours: mixed pixels, glancing rays, bad matches.
///
/// A share p of the points has noise of `times` times what the rest has, and they lie among the others. Found
/// from what a first smoothing left between each point and the surface, r in units of the noise around it, by
/// expectation maximisation (Dempster, Laird and Rubin 1977) of
///
///     (1 - p) N(0, s^2) + p N(0, (times s)^2).
///
/// Such a point says less of where the surface is, and how much less, its residual tells. With
///
///     psi(r) = r (P(narrow | r) + P(wide | r) / times^2),    J = mean of psi^2 / s^2 = mean of psi',
///
/// s^2 times the score of the mixture and s^2 times its information, the residual becomes psi / J: a
/// pseudo-observation (Huber 1981, Robust Statistics, 7.8), on which everything that assumes one normal
/// distribution can go on. It follows the surface that the points show and not the one it was taken from,
/// since the mean of (psi / J)' is 1, and its variance is the least that this law allows, s^2 / J.
#pragma once

#include <vector>

#include <rfsmooth/statistics.h>

namespace rfsmooth::smoothing {

/// Share of the points: more are noise that differs over the cloud, or around a point that is shape.
constexpr double kMostInTails = 0.35;

/// The law of a cloud's tails.
class Tails : public Statistics::Tails {
 public:
  Tails() = default;
  /// O(1).
  explicit Tails(const Statistics::Tails& known);

  /// What a residual of r (in units of the measured noise) is to be multiplied by: psi / (J r).
  double weight(double r) const;

  /// Standard deviation of the pseudo-observations over the measured noise.
  double noise() const;

  /// The standard normal value that is as rare as a residual of r (in units of the measured noise) in this
  /// law; r itself without tails. Within 8 in absolute value.
  double normal_score(double r) const;

  /// What a normal score of 1 is near 0, in units of the measured noise.
  double unit() const;

 private:
  double of_score(double t) const;  ///< psi / r at r = t s

  double information_ = 1;  ///< J
};

/// \param residuals over the noise around each point, of either sign, of a surface that does not follow the
/// points. \param least the same of one that follows edges, not negative: whether there are tails. Of points
/// that have no part in it both are NaN. O(n).
Statistics::Tails find_tails(const std::vector<float>& residuals, const std::vector<float>& least);

}  // namespace rfsmooth::smoothing
