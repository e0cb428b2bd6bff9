/// The plan of a job as JSON, in the file job.json of its folder.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "pipeline/tiles/job.h"

namespace rfsmooth::pipeline::tiles {

/// Its file.
std::filesystem::path plan_file(const std::filesystem::path& folder);

/// All that the file says.
nlohmann::ordered_json json_of_job(const Job& job, const PlanOptions& how);

/// What the file says. \throw Failure (input_unreadable) where there is none, and where it is no JSON.
nlohmann::ordered_json read_plan(const std::filesystem::path& folder);

/// The job of that. \throw Failure (input_unreadable) where something is missing or of another kind.
Job job_of(const nlohmann::ordered_json& json, const std::filesystem::path& folder);

}  // namespace rfsmooth::pipeline::tiles
