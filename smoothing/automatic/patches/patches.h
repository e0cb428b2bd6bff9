/// Overlapping local quadrics over a height field: at every point several predict its height, and their
/// average is a smoother with a known share of the point's own value in it.
///
/// Source: aggregation of overlapping local estimates as in image denoising (Katkovnik et al. 2010, "From
/// local kernel to nonlocal multiple-model image denoising", section 6); the constants are ours.
/// Const functions are thread safe.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "smoothing/automatic/guide/height_field.h"
#include "smoothing/automatic/patches/patch_members.h"

namespace rfsmooth::smoothing {

/// What the patches say of every point.
struct Prediction {
  std::vector<float> height;  ///< n, along the point's own normal over the guide
  std::vector<float> own;     ///< n: d height_i / d z_i, the share of the point's own height
  std::vector<char>
      covered;  ///< n: whether any patch reaches the point; height and own are 0 where none does
};

/// The share of a point's noise that stays in a prediction which has the share `own` of its height: that of
/// all who share the noise (automatic.h).
inline float own_of_all(float own, float shared) {
  return own * shared / (1 + own * (shared - 1));
}

/// Overlapping quadrics over one number of points.
class Patches {
 public:
  /// Patches of `members` points each (at most the number of points) around the points `seeds`, evenly
  /// spread; eight patches over a point are good (16 gain 2 % of the error at twice the time). Places that
  /// they leave uncovered get seeds of their own. \param sigma n: the noise, world units, > 0: how much a
  /// patch counts, and whether it sees several sheets. `memory` is for their members, outlives them and
  /// belongs to one Patches at a time. O(n log n); memory 6 bytes a point and patch over it, beside 14 bytes
  /// of each of the 262,144 members, or of the 512 patches if these are more, that are fitted side by side.
  /// \throw std::invalid_argument without seeds or members, Failure for 2^32 members in all.
  Patches(const HeightField& field, std::size_t members, std::vector<Index> seeds,
          const std::vector<double>& sigma, PatchMembers& memory, const Context& context);

  /// What they say; to be taken once.
  Prediction take_prediction() { return std::move(prediction_); }

  /// Seeds, ascending (one may come twice), of the patches that see more than one sheet: residuals that vary
  /// by more than the noise.
  const std::vector<Index>& with_several_sheets() const { return several_; }

  /// Averages over patches of the patches' averages, in place: a mean over about twice `members` points. Of
  /// one value or several of each point: reading the members is what takes the time. \param values each n.
  /// Not after another Patches was given the same memory. O(members of all patches).
  template <std::size_t kCount>
  void average(const std::array<std::vector<float>*, kCount>& values, const Context& context) const;

 private:
  struct Wave;
  /// What is said of every point, added up patch by patch.
  struct Sums;

  void fit(std::size_t first, const std::vector<double>& sigma, Sums& sums, const Context& context);
  void fit_wave(Wave& wave, const std::vector<double>& sigma, const Context& context) const;
  void cover_missing(const std::vector<double>& sigma, Sums& sums, const Context& context);

  const HeightField& field_;
  std::size_t members_ = 0;
  std::vector<Index> seeds_;
  PatchMembers& memory_;
  Prediction prediction_;
  std::vector<float> around_;  ///< n: sum of the point's weights in all of them, in 1/65535
  std::vector<Index> several_;
};

}  // namespace rfsmooth::smoothing
