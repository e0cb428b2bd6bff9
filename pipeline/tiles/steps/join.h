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
  io::RefinedScale scale;            ///< of LAS; all zeros where it was not looked at
  double noise = 0, noise_left = 0;  ///< for which it was
};

/// Needs every tile run. `outputs`: one for each input, of its format. Files in their place are replaced if
/// `force`. LAS: scales that are coarse for what is left of the noise are refined, unless `keep_scale` or
/// nothing moved. `normals`: whether the tiles were run with them. Returns one for each input. \throw Failure
/// (usage) naming the first tile that is not.
std::vector<Joined> join_job(const Job& job, const std::vector<std::string>& outputs, bool force,
                             bool keep_scale, bool normals, const Context& context);

}  // namespace rfsmooth::pipeline::tiles
