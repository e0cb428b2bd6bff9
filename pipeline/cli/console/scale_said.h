/// What is said of LAS files beside what was done to the points.
#pragma once

#include <optional>
#include <string>

#include "pipeline/cli/console/console.h"
#include "pipeline/io/formats/las/las_scale.h"

namespace rfsmooth::cli {

/// Says that the scale was refined, and warns where it is coarse for noise of which so much is left. Nothing
/// for scales of 0, which stand for no LAS. `name`: of the input; `kept`: as --keep-scale asks.
void tell_scale(const std::string& name, const pipeline::io::RefinedScale& scale, bool kept, double noise,
                std::optional<double> noise_left, Console& console);

/// An index lies beside the LAS file it is of: warns of one that the output makes stale.
void warn_of_index(const std::string& output, Console& console);

}  // namespace rfsmooth::cli
