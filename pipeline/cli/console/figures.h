/// The figures that info and compare print, as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include <rfsmooth/compare.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::cli {

/// Format, encoding, fields, finite and distinct points, bounding box, spacing, noise. O(n log n).
/// \throw Failure.
nlohmann::ordered_json info_of(const pipeline::io::Cloud& cloud, const Context& context);

/// A comparison's figures, in own units and on the truth's unit sphere.
nlohmann::ordered_json figures_of(const CompareReport& report);

}  // namespace rfsmooth::cli
