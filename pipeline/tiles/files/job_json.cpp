#include "pipeline/tiles/files/job_json.h"

#include <system_error>

#include "base/fail.h"
#include "pipeline/io/json_file.h"
#include "pipeline/tiles/files/statistics_json.h"

namespace rfsmooth::pipeline::tiles {

using nlohmann::ordered_json;

std::filesystem::path plan_file(const std::filesystem::path& folder) {
  return folder / "job.json";
}

ordered_json json_of_job(const Job& job, const PlanOptions& how) {
  ordered_json json = {
      {"rfsmooth_tiles", 1},      {"tile_points", how.tile_points}, {"sample_points", how.sample_points},
      {"options", job.options},   {"points", job.points},           {"sample", job.sample},
      {"measured", job.measured}, {"box", json_of(job.box)}};
  json["inputs"] = ordered_json::array();
  for (const JobInput& input : job.inputs)
    json["inputs"].push_back(
        {{"path", input.path}, {"rows", input.rows}, {"bytes", input.bytes}, {"changed", input.changed}});
  json["tiles"] = ordered_json::array();
  for (const Tile& tile : job.tiles)
    json["tiles"].push_back({{"points", tile.points}, {"box", json_of(tile.box)}});
  for (const RepeatedPlace& place : job.repeated)
    json["repeated"].push_back(
        {{"first", place.first}, {"others", place.others}, {"at", json_of_place(place.at)}});
  return json;
}

ordered_json read_plan(const std::filesystem::path& folder) {
  if (std::error_code unknown; !std::filesystem::exists(plan_file(folder), unknown))
    fail(ErrorCode::input_unreadable, "{}: holds no job (rfsmooth tiles plan makes one)", folder.string());
  return io::read_json(plan_file(folder));
}

Job job_of(const ordered_json& json, const std::filesystem::path& folder) {
  Job job;
  job.folder = folder;
  try {
    job.options = json.at("options");
    job.points = json.at("points");
    job.sample = json.at("sample");
    job.measured = json.at("measured");
    job.box = box_of(json.at("box"));
    for (const auto& input : json.at("inputs"))
      job.inputs.push_back({input.at("path"), input.at("rows"), input.at("bytes"), input.at("changed")});
    for (const auto& tile : json.at("tiles"))
      job.tiles.push_back({box_of(tile.at("box")), tile.at("points")});
    if (!json.contains("repeated")) return job;
    for (const auto& place : json.at("repeated"))
      job.repeated.push_back({place_of(place.at("at")), place.at("first"), place.at("others")});
  } catch (const nlohmann::json::exception& error) {
    fail(ErrorCode::input_unreadable, "{}: is no plan: {}", plan_file(folder).string(), io::said_of(error));
  }
  return job;
}

}  // namespace rfsmooth::pipeline::tiles
