/// The second step, for every tile: takes its part of the sample.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <rfsmooth/context.h>

#include "pipeline/tiles/files/records.h"
#include "pipeline/tiles/job.h"

namespace rfsmooth::pipeline::tiles {

/// Writes job.sampled(tile), unless it is there. \throw Failure.
void measure_tile(const Job& job, std::size_t tile, const Context& context);

/// Whether that was done.
bool is_measured(const Job& job, std::size_t tile, const Context& context);

/// Leaves so many of a tile's points that all tiles have `wanted` together: those nearest to the one in the
/// middle of the tile, a piece of the surface that is as whole as it can be. By rows. O(n log n).
void keep_middle(const Job& job, std::size_t tile, std::uint64_t wanted, std::vector<Record>& points);

}  // namespace rfsmooth::pipeline::tiles
