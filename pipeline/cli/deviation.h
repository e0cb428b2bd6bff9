/// How far a cloud is from the truth: the figures a user asks for, and colours.
#pragma once

#include <string>
#include <vector>

#include "pipeline/io/io.h"

namespace rfsmooth::cli {

/// Of distances, in their own units.
struct Deviation {
  double rms = 0, median = 0, most = 0, largest = 0;  ///< `most`: 95 % are at most this far
};

/// Sums up the distances that are finite; at least one is. O(n).
Deviation summed_up(std::vector<double> distances);

/// Gives every point a field 'deviation' (float32) and a colour in the way of the format of `output` (red,
/// green, blue; PCD: rgb): blue at 0, through green at red / 2, to red. Points that are not finite become
/// grey. Colours that were there are replaced. \throw Failure (usage) if a field of those names cannot take
/// them.
void color_by_deviation(pipeline::io::Cloud& cloud, const std::vector<double>& distances, double red,
                        const std::string& output, const Context& context);

}  // namespace rfsmooth::cli
