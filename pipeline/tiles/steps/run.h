/// The fourth step, for every tile: smooths it with what lies around it, and keeps what is its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include <rfsmooth/denoise.h>
#include <rfsmooth/normals.h>

#include "pipeline/tiles/job.h"

namespace rfsmooth::pipeline::tiles {

/// Writes job.done(tile) and what goes with it, unless it is there. Needs the job settled. \param normals how
/// to find them, if at all. \param most of the tile's points and those around it: where these are more, what
/// lies around is made narrower. \throw Failure.
void run_tile(const Job& job, std::size_t tile, const DenoiseOptions& options,
              const std::optional<NormalsOptions>& normals, const Context& context,
              std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

/// Whether a tile is smoothed, and has its normals if it is to have some. Reads the results in full.
bool is_run(const Job& job, std::size_t tile, bool normals, const Context& context);

/// The points that a tile of a settled job is smoothed with, its own among them. \throw Failure.
std::uint64_t points_with_halo(const Job& job, std::size_t tile, const Context& context);

}  // namespace rfsmooth::pipeline::tiles
