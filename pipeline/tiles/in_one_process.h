/// All steps of a job one after the other, in a folder that goes when it is done.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <rfsmooth/denoise.h>
#include <rfsmooth/normals.h>

#include "pipeline/io/table/cloud.h"
#include "pipeline/tiles/job.h"
#include "pipeline/tiles/steps/join.h"

namespace rfsmooth::pipeline::tiles {

/// How to stay within some memory.
struct Within {
  PlanOptions plan;
  std::uint64_t most = 0;  ///< points of a tile with what lies around it
};

/// How many points a tile and the sample may have so that the work, with normals or without, takes at
/// most `memory` bytes, which is least_memory or more.
Within plan_within(std::uint64_t memory, bool normals);

/// The least memory that a cloud of so many points is smoothed in where its noise is usual; bytes.
std::uint64_t least_memory(std::uint64_t points, bool normals);

/// A file that can be read in pieces.
struct InPieces {
  std::uint64_t rows = 0;
  io::Format format{};
};

/// None: text, compressed, missing.
std::optional<InPieces> in_pieces(const std::string& path, const Context& context);

/// Its rows whose coordinates are finite. Reads all of it. \throw Failure.
std::uint64_t finite_rows(const std::string& path, const Context& context);

/// A file to smooth in tiles.
struct TiledRun {
  std::string input, output;
  JoinOptions join = {};  ///< its folder is made at once; its normals follow from those that are asked for
};

/// What there is to say of a cloud smoothed in tiles.
struct SmoothedInTiles {
  Joined joined;
  DenoiseReport report;      ///< of report_of
  bool had_normals = false;  ///< whether the input has fields of that name
};

/// Smooths a file in tiles, in a folder beside the output, which is a file (io::file_behind). Tiles that are
/// more than how.most points with what lies around them are halved; where that does not help, less is taken
/// around them, and one whose points are more and all at one place is refused (out_of_memory). Reports one
/// stage, "tiles". The folder stays after an error or a cancel of the caller's only if it cannot be removed.
/// \throw Failure.
SmoothedInTiles smooth_in_tiles(const TiledRun& run, const Within& how, const DenoiseOptions& options,
                                const std::optional<NormalsOptions>& normals, const Context& context);

}  // namespace rfsmooth::pipeline::tiles
