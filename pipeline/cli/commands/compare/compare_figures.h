/// The figures that compare prints, as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include <rfsmooth/compare.h>

#include "pipeline/cli/deviation.h"

namespace rfsmooth::cli {

/// A comparison's figures, in own units and on the truth's unit sphere.
nlohmann::ordered_json figures_of(const CompareReport& report, const Deviation& deviation);

}  // namespace rfsmooth::cli
