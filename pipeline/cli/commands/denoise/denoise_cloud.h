/// One cloud, denoised as a whole: what rfsmooth denoise does between reading it and writing it.
#pragma once

#include <string>
#include <vector>

#include <rfsmooth/denoise.h>

#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/commands/denoise/denoise_options.h"
#include "pipeline/io/table/field.h"

namespace rfsmooth::cli {

/// What is written beside the cloud, once that is there.
struct Beside {
  std::string command;  ///< that was typed
  std::string page;
  std::vector<TraceRow> trace;
};

/// The fields that are not normals and that the cloud gets, unless it has them.
std::vector<pipeline::io::Field> added_fields(const DenoiseCommandOptions& options);

/// Smooths the cloud, adds the fields that were asked for, says what was done, and makes ready what stands
/// beside it. Returns the summary. \throw Failure.
std::string denoise_cloud(const DenoiseCommandOptions& options, Beside& beside, pipeline::io::Cloud& cloud,
                          const CloudTask& task);

}  // namespace rfsmooth::cli
