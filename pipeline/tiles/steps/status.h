/// How far a job is, and what has become of the cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <rfsmooth/denoise.h>

#include "pipeline/tiles/job.h"

namespace rfsmooth::pipeline::tiles {

/// How far a job is.
struct JobStatus {
  std::size_t tiles = 0, measured = 0, run = 0;
  bool settled = false;
  double halo = 0;        ///< typical width of the surroundings, world units; 0 until settled
  double halo_share = 0;  ///< points around the tiles that were run, over those in them
  double seconds = 0;     ///< of processor time that these took
  std::uint64_t points = 0;
  std::vector<std::size_t> missing;  ///< tiles not run
};
/// Reads every result in full: one that is not as it was written counts as missing.
JobStatus job_status(const Job& job, const Context& context);

/// What there is to say of a job whose tiles were run, as of a whole cloud, but for its mesh. Moves are those
/// before the coordinates were written. \throw Failure.
DenoiseReport report_of(const Job& job, const DenoiseOptions& options);

}  // namespace rfsmooth::pipeline::tiles
