/// What may be smoothed in tiles: options by which only points near by have a say in where a point goes, and
/// outputs of the input's format.
#pragma once

#include <string>

#include <rfsmooth/denoise.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::tiles {

/// Refuses options by which points at any distance may have a say in where a point goes. \throw Failure
/// (usage) naming what can be done.
void check_for_tiles(const DenoiseOptions& options);

/// \throw Failure (usage) if the output's extension is of another format.
void check_format(io::Format input, const std::string& output);

}  // namespace rfsmooth::pipeline::tiles
