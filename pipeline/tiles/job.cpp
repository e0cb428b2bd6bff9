#include "pipeline/tiles/job.h"

#include <fstream>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/tiles/files/job_json.h"

namespace rfsmooth::pipeline::tiles {

Job open_job(const std::filesystem::path& folder) {
  return job_of(read_plan(folder), folder);
}

nlohmann::ordered_json read_cost(const Job& job, std::size_t tile) {
  using nlohmann::ordered_json;
  std::ifstream file(job.cost(tile));
  ordered_json cost = ordered_json::parse(file, nullptr, false);
  return cost.is_object() ? cost : ordered_json::object();
}

void refuse_step(const Job& job, const std::string& message) {
  fail(ErrorCode::usage, "{}: {}", job.folder.string(), message);
}

void check_tile(const Job& job, std::size_t tile) {
  if (tile >= job.tiles.size())
    refuse_step(job, fmt::format("there is no tile {}; they are 0 to {}", tile, job.tiles.size() - 1));
}

}  // namespace rfsmooth::pipeline::tiles
