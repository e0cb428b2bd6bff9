/// The figures that info prints, as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::cli {

/// Format, encoding, fields, finite and distinct points, bounding box, spacing, noise. O(n log n).
/// \throw Failure.
nlohmann::ordered_json info_of(const pipeline::io::Cloud& cloud, const Context& context);

}  // namespace rfsmooth::cli
