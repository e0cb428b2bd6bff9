/// --memory: what a cloud takes as a whole, and where it is smoothed in tiles.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/cli/commands/denoise/denoise_options.h"
#include "pipeline/cli/jobs.h"

namespace rfsmooth::cli {

/// `xyz`: n x 3. \throw Failure if the cloud, which cannot go in tiles, needs more than --memory says.
void check_memory(const DenoiseCommandOptions& options, const Job& job, const std::vector<double>& xyz,
                  const Context& context);

/// The memory to stay in, if the cloud is smoothed in tiles: where one file needs more. None: as a whole.
/// \throw Failure (usage) where --memory asks for tiles and they are not possible.
std::optional<std::uint64_t> memory_of_tiles(const DenoiseCommandOptions& options, const Job& job,
                                             const Context& context);

}  // namespace rfsmooth::cli
