/// The last step: copies the inputs with the new coordinates in them.
#pragma once

#include <string>
#include <vector>

#include <rfsmooth/context.h>

#include "pipeline/io/formats/las/las_scale.h"
#include "pipeline/tiles/job.h"

namespace rfsmooth::pipeline::tiles {

/// What there is to say of an output.
struct Joined {
  bool las = false;
  io::RefinedScale scale;  ///< of LAS; all zeros where it was not looked at
};

/// How to join.
struct JoinOptions {
  bool force = false;       ///< replaces files in the place of the outputs
  bool keep_scale = false;  ///< of LAS: does not refine scales that are coarse for what is left of the noise
  bool normals = false;     ///< whether the tiles were run with them
  std::string folder = {};  ///< of the outputs, if it is still to be made before they are written
};

/// Needs every tile run. `outputs`: one for each input, of its format. A scale of LAS is refined only where
/// something moved. Returns one for each input. \throw Failure (usage) naming the first tile that is not.
std::vector<Joined> join_job(const Job& job, const std::vector<std::string>& outputs, const JoinOptions& how,
                             const Context& context);

}  // namespace rfsmooth::pipeline::tiles
