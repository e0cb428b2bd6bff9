/// All steps of a job one after the other, in a folder that goes when it is done.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pipeline/tiles/job.h"

namespace rfsmooth::pipeline::tiles {

/// How many points a tile and the sample may have so that the work, with normals or without, takes at
/// most `memory` bytes.
PlanOptions plan_within(std::uint64_t memory, bool normals);

/// A file that can be read in pieces.
struct InPieces {
  std::uint64_t rows = 0;
  io::Format format{};
};

/// None: text, compressed, missing.
std::optional<InPieces> in_pieces(const std::string& path, const Context& context);

/// Smooths `input` to `output` in tiles, in a folder beside the output. Reports one stage, "tiles". The
/// folder stays after an error or a cancel of the caller's only if it cannot be removed. \throw Failure.
Joined smooth_in_tiles(const std::string& input, const std::string& output, bool force, bool keep_scale,
                       const PlanOptions& how, const DenoiseOptions& options,
                       const std::optional<NormalsOptions>& normals, const Context& context);

}  // namespace rfsmooth::pipeline::tiles
