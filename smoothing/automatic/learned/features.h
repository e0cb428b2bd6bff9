/// What the learned step (last_step.h) is told about a point: numbers that the automatic smoother knows
/// there.
///
/// All lengths are in units of s, the noise around the point (at most the cloud's figure: walls make the
/// field too high), heights along the point's normal n over the guide, from h = (P - g) n, P being the place
/// that the mixture, hidden sheets and thin walls gave it. So a cloud that is turned, moved or made larger
/// has the same features. Turning the normals round changes the sign of the odd features and leaves the even
/// ones as they are.
///
/// From the scales (patches.h): the four narrowest and the widest, the widest in place of those that are not
/// there.
///     even: own, the evidence near and wide (automatic.h), clipped at 3 s^2; odd: f_m - h, clipped at 5 s, 0
///     where the scale says nothing
/// Of the point: r = z - h, what smoothing took, clipped at 6 s; the height that the mixture gave it (odd),
/// the share of its own height. Moments around it: means of r, r^3 / 6 (odd), r^2, r^4 / 6 (even) over points
/// of the same sheet within 3 and 6 s; these and own, (f_0 - h)^2 and (f_2 - h)^2 (even) over the near
/// neighbours of near neighbours, four times. Histograms: heights of the data around P in bins of 0.75 from
/// -4.5 to 4.5 s, over discs of 3 and 6 s, as sums (even) and differences (odd) of bins that mirror each
/// other; how many points there are. Smoothed points within 5 s, of any sheet: mean height, of all, of those
/// that face the same way and of those that face the other way (odd), mean square height over 4, and how they
/// face: along, against, either (even). Second moments of the data within 6 s: along n and the two along the
/// surface, and the offsets of the mean. Of the cloud: x / (1 + x) of x = s in spacings, s over the field's
/// noise here, the variance of the noise where it has hidden sheets (hidden_sheets.h), over that measured.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "rfs_mesh/noise/noise.h"
#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/guide/height_field.h"
#include "smoothing/automatic/learned/seen.h"

namespace rfsmooth::smoothing {

/// s, world units.
inline float learned_unit(const rfs_mesh::NoiseField& noise, std::size_t i) {
  return float(std::min(noise.local[i], noise.sigma));
}

/// What a scale said of one point. In half precision: three digits are enough for features, and all scales of
/// all points are kept.
struct ScaleSays {
  Eigen::half off;         ///< s: its height less that of the data; NaN where no patch is
  Eigen::half own;         ///< 0 to 1
  Eigen::half near, wide;  ///< sigma^2: the risk's difference to the scale before, as near neighbours and as
                           ///< its patches average it
};
constexpr std::size_t kTold = 5;  ///< scales that features are made of
/// What those scales say of a point.
using ScalesSay = std::array<ScaleSays, kTold>;

/// The scale that stands at place t of ScalesSay, of `count` scales.
constexpr std::size_t told_scale(std::size_t t, std::size_t count) {
  return t + 1 < kTold && t < count ? t : count - 1;
}

/// What the automatic smoother made of the points, and what it knew. Arrays: n.
struct Smoothed {
  const std::vector<ScalesSay>& scales;
  const std::vector<float>& own;    ///< of the mixture, as in Prediction
  const std::vector<float>& mixed;  ///< its height, world units, before hidden sheets
  const Positions& place;           ///< P, world units
  double variance;                  ///< of the noise over that measured, as hidden sheets tell; else 1
};

/// The features of the points of a field. Const functions are thread safe.
class Features {
 public:
  // Of the scales, own, means, bins, numbers, sheets, moments, cloud; of the scales, point, means, bins,
  // sheets, moments.
  static constexpr std::size_t kEven = 3 * kTold + 1 + 9 + 14 + 2 + 4 + 4 + 3;
  static constexpr std::size_t kOdd = kTold + 2 + 6 + 12 + 3 + 1;

  /// The features of one point.
  struct Row {
    std::array<float, kEven> even;
    std::array<float, kOdd> odd;
  };

  /// The arguments outlive it. O(n), parallel, the same bits for any number of threads.
  Features(HeightField& field, const Positions& data, const Smoothed& smoothed,
           const rfs_mesh::NoiseField& noise, const Context& context);

  /// s, world units.
  float unit(std::size_t i) const { return learned_unit(noise_, i); }

  /// For a thread that goes from point to point.
  Surroundings start() const { return {field_, packed_}; }

  /// O(points within 6.5 s, at most Surroundings::kMost), fastest from point to point along a Morton curve.
  /// The last bits depend on the points that `near` was with before.
  void fill(std::size_t i, Row& row, Surroundings& near) const;

 private:
  float candidate(std::size_t i, float off) const;  ///< f - h, clipped, of off = f - z, in s; 0 for NaN
  float height(std::size_t i) const {               ///< h, world units
    return float((smoothed_.place[i] - field_.guide()[i]).dot(field_.normal(i)));
  }

  const HeightField& field_;
  const Smoothed smoothed_;
  const rfs_mesh::NoiseField& noise_;
  std::vector<Packed> packed_;                   ///< n
  std::vector<HeightField::Columns<8>> pooled_;  ///< n: moments
};

}  // namespace rfsmooth::smoothing
