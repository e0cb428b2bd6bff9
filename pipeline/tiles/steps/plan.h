/// The first step: cuts the cloud into tiles of about as many points, each row in one of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <rfsmooth/context.h>

#include "pipeline/tiles/job.h"

namespace rfsmooth::pipeline::tiles {

/// Plans a job, unless the folder holds one of the same inputs and options. Reads the inputs twice, and once
/// more for every 500 tiles but the first. \throw Failure.
Job plan_job(const std::vector<std::string>& inputs, const std::filesystem::path& folder,
             const PlanOptions& how, const nlohmann::ordered_json& options, const Context& context);

/// Halves a tile; the new one is the last, and the plan on the disk does not know of it. False if all of its
/// points are at one place. Before the first tile is run. \throw Failure.
bool split_tile(Job& job, std::size_t tile, const Context& context);

}  // namespace rfsmooth::pipeline::tiles
