/// Patches of many sizes over one field, and their mixture: steps 2 and 3 of automatic.h. Thread safe: no
/// state is kept.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/statistics.h>

#include "rfs_mesh/noise/noise.h"
#include "smoothing/automatic/guide/height_field.h"
#include "smoothing/automatic/learned/features.h"
#include "smoothing/automatic/patches/mixture.h"

namespace rfsmooth::smoothing {

/// The heights that all scales together give, and what single scales say.
struct MixedScales {
  std::vector<float> height;    ///< n: of the mixture, as in Prediction
  std::vector<float> own;       ///< n: share of the point's noise that stays in it: own_of_all of patches.h
  Left left;                    ///< what they are off by
  std::vector<float> wide;      ///< n: of the scale that looks for tails
  std::vector<ScalesSay> told;  ///< n, or empty without the learned step
  std::vector<Index> several;   ///< places where the scale that looks for walls sees several sheets
  std::size_t members_seeing = 0;  ///< of that scale
};

/// Of scales that begin at a radius of 4.5 sigma and go on doubling their points. \param learned whether the
/// learned step will be taken. Leaves the field ready for means. \param whole how those of the whole
/// cloud are made; what is not there is entered. O(n) times the number of scales, about eight; parallel, the
/// same bits for any number of threads.
MixedScales smooth_heights(HeightField& field, const rfs_mesh::NoiseField& noise, bool learned,
                           Statistics::Pass& whole, const Context& context);

}  // namespace rfsmooth::smoothing
