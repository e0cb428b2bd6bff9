/// The deviation of a cloud from the truth, as figures and as colours.
#pragma once

#include <string>
#include <vector>

#include "pipeline/io/io.h"

namespace rfsmooth::cli {

/// Statistics of distances, in the same units.
struct Deviation {
  double rms = 0, median = 0, most = 0, largest = 0;  ///< `most`: 95 % are at most this far
};

/// Summarises the finite distances, of which there must be one. O(n).
Deviation summed_up(std::vector<double> distances);

/// Gives every point a field 'deviation' (float32) and a colour: blue at 0, green at red / 2, red from `red`
/// on; where `red` is 0 whatever is farther than that is red. Points that are not finite become grey. Colours
/// that the points have are replaced, whether in red, green, blue or packed in rgb, rgba; points without any
/// get them as the format of `output` stores them (red, green, blue; PCD: rgb). \throw Failure (usage) if
/// existing fields of those names cannot take the values.
void color_by_deviation(pipeline::io::Cloud& cloud, const std::vector<double>& distances, double red,
                        const std::string& output, const Context& context);

}  // namespace rfsmooth::cli
