/// The third step: finds what the cloud as a whole is like (rfsmooth/statistics.h), the noise of the sample
/// and the rest of a part of it that is smoothed, and how much around a tile has a say in it.
#pragma once

#include <cstddef>
#include <filesystem>

#include <rfsmooth/denoise.h>

#include "pipeline/tiles/job.h"

namespace rfsmooth::pipeline::tiles {

/// What it found.
struct Settled {
  DenoiseReport report;    ///< of the sample: its statistics, spacing and noise; nothing else is kept
  double halo = 0;         ///< typical width of what a tile is smoothed with, world units
  double radii = 0;        ///< the same in radii of the widest patch
  std::size_t widest = 0;  ///< points of that
};

/// Writes job.settled(), unless it is there. Needs every tile measured. \throw Failure (usage) naming the
/// first that is not.
void settle_job(const Job& job, const DenoiseOptions& options, const Context& context);

/// Whether that was done.
bool is_settled(const Job& job);

/// What it found for a job. \throw Failure: usage if it was not done yet, input_unreadable.
Settled settled_of(const Job& job);

/// The same from a file. \throw Failure (input_unreadable).
Settled read_settled(const std::filesystem::path& path);

}  // namespace rfsmooth::pipeline::tiles
