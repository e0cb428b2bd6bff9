/// What rfsmooth denoise says of a cloud that it has smoothed, in words.
#pragma once

#include <string>

#include "pipeline/cli/commands/denoise/denoise_options.h"
#include "pipeline/cli/console/console.h"
#include "pipeline/cli/jobs.h"

namespace rfsmooth::cli {

/// Points that are not finite, and normals that are stale.
/// \param had_normals whether the input has fields of that name
/// \param as_las whether the output is LAS
void tell_points(const DenoiseReport& done, const DenoiseCommandOptions& options, bool had_normals,
                 bool as_las, const Job& job, Console& console);

/// What came in, its noise, and how far it moved: a line each.
/// \param with_outliers what went with the outliers, in words that follow theirs
std::string summary(const DenoiseReport& done, const DenoiseCommandOptions& options,
                    const std::string& with_outliers = {});

}  // namespace rfsmooth::cli
