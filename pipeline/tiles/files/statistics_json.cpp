#include "pipeline/tiles/files/statistics_json.h"

#include <array>

namespace rfsmooth::pipeline::tiles {

namespace {

using nlohmann::ordered_json;

constexpr std::array<const char*, 4> kNotSmoothed = {"no-iterations", "no-strength", "too-few-points",
                                                     "too-little-noise"};  // in the order of NotSmoothed

ordered_json json_of_noise(const NoiseModel& noise) {
  ordered_json json = {{"sigma", noise.sigma},       {"shape", noise.shape},      {"spacing", noise.spacing},
                       {"apart", noise.apart},       {"shared_by", noise.shared}, {"piece", noise.piece},
                       {"on_lines", noise.on_lines}, {"depth_step", noise.step},  {"on_grid", noise.on_grid},
                       {"rounding", noise.rounding}, {"at_sites", noise.at_sites}};
  if (!noise.spacing_at_sites.empty()) json["spacing_at_sites"] = noise.spacing_at_sites;
  if (!noise.told_at_sites.empty()) json["told_at_sites"] = noise.told_at_sites;
  if (!noise.shared_at_sites.empty()) json["shared_at_sites"] = noise.shared_at_sites;
  json["sites"] = ordered_json::array();
  for (const auto& p : noise.sites) json["sites"].push_back(json_of_place(p));
  return json;
}

NoiseModel noise_of(const ordered_json& json) {
  NoiseModel noise;
  noise.sigma = json.at("sigma");
  noise.shape = json.at("shape");
  noise.spacing = json.at("spacing");
  noise.apart = json.at("apart");
  noise.shared = json.at("shared_by");
  noise.step = json.at("depth_step");
  noise.on_grid = json.at("on_grid");
  noise.rounding = json.at("rounding");
  noise.piece = json.at("piece");
  noise.on_lines = json.at("on_lines");
  noise.at_sites = json.at("at_sites").get<std::vector<double>>();
  noise.spacing_at_sites = json.value("spacing_at_sites", noise.spacing_at_sites);
  noise.told_at_sites = json.value("told_at_sites", noise.told_at_sites);
  noise.shared_at_sites = json.value("shared_at_sites", noise.shared_at_sites);
  for (const auto& p : json.at("sites")) noise.sites.push_back(place_of(p));
  return noise;
}

ordered_json json_of_patches(const Statistics::Scale& scale) {
  return {{"members", scale.members}, {"thinnings", scale.thinnings}};
}

Statistics::Scale patches_of(const ordered_json& json) {
  return {json.at("members"), json.at("thinnings")};
}

ordered_json json_of_pass(const Statistics::Pass& pass) {
  ordered_json json = {{"shares", pass.shares}};
  json["scales"] = ordered_json::array();
  for (const auto& s : pass.scales) json["scales"].push_back(json_of_patches(s));
  if (pass.narrow) json["narrow"] = json_of_patches(*pass.narrow);
  return json;
}

Statistics::Pass pass_of(const ordered_json& json) {
  Statistics::Pass pass;
  pass.shares = json.at("shares").get<std::vector<double>>();
  for (const auto& s : json.at("scales")) pass.scales.push_back(patches_of(s));
  if (json.contains("narrow")) pass.narrow = patches_of(json.at("narrow"));
  return pass;
}

}  // namespace

ordered_json json_of_place(const Eigen::Vector3d& p) {
  return {p[0], p[1], p[2]};
}

Eigen::Vector3d place_of(const ordered_json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

ordered_json json_of(const Statistics::Box& box) {
  return {json_of_place(box.low), json_of_place(box.high)};
}

Statistics::Box box_of(const ordered_json& json) {
  return {place_of(json.at(0)), place_of(json.at(1))};
}

ordered_json json_of(const Statistics& all) {
  ordered_json json = ordered_json::object();
  if (all.box) json["box"] = json_of(*all.box);
  if (all.points) json["points"] = *all.points;
  if (all.reach) json["reach"] = *all.reach;
  if (const auto& scale = all.scale)
    json["scale"] = {{"sigma", scale->sigma}, {"neighbours", scale->neighbours}, {"radius", scale->radius}};
  if (all.spacing) json["spacing"] = *all.spacing;
  if (all.noise) json["noise"] = json_of_noise(*all.noise);
  if (all.tails)
    json["tails"] = {{"share", all.tails->share},
                     {"times", all.tails->times},
                     {"narrow", all.tails->narrow},
                     {"together", all.tails->together}};
  json["passes"] = ordered_json::array();
  for (const auto& pass : all.passes) json["passes"].push_back(json_of_pass(pass));
  if (all.sheets) json["sheets"] = {{"evidence", all.sheets->evidence}, {"variance", all.sheets->variance}};
  if (all.thin_walls) json["thin_walls"] = *all.thin_walls;
  for (const auto& part : all.parts)
    json["parts"].push_back({{"from", part.from}, {"statistics", json_of(part.own)}});
  return json;
}

Statistics statistics_of(const ordered_json& json) {
  Statistics all;
  if (json.contains("box")) all.box = box_of(json.at("box"));
  if (json.contains("points")) all.points = json.at("points").get<std::size_t>();
  if (json.contains("reach")) all.reach = json.at("reach").get<double>();
  if (json.contains("scale")) {
    const auto& scale = json.at("scale");
    all.scale = NoiseScale{scale.at("sigma"), scale.at("neighbours"), scale.at("radius")};
  }
  if (json.contains("spacing")) all.spacing = json.at("spacing").get<double>();
  if (json.contains("noise")) all.noise = noise_of(json.at("noise"));
  if (json.contains("tails")) {
    const auto& tails = json.at("tails");
    all.tails = {tails.at("share").get<double>(), tails.at("times").get<double>(),
                 tails.at("narrow").get<double>(), tails.at("together").get<double>()};
  }
  for (const auto& pass : json.at("passes")) all.passes.push_back(pass_of(pass));
  if (json.contains("sheets"))
    all.sheets = {json.at("sheets").at("evidence").get<double>(),
                  json.at("sheets").at("variance").get<double>()};
  if (json.contains("thin_walls")) all.thin_walls = json.at("thin_walls").get<bool>();
  if (json.contains("parts"))
    for (const auto& part : json.at("parts"))
      all.parts.push_back({part.at("from"), statistics_of(part.at("statistics"))});
  return all;
}

ordered_json json_of(const NoiseSummary& noise) {
  return {{"typical", noise.typical}, {"loudest_tenth", noise.loudest}, {"shared_by", noise.shared},
          {"depth_step", noise.step}, {"on_grid", noise.on_grid},       {"on_lines", noise.on_lines}};
}

NoiseSummary summary_of(const ordered_json& json) {
  return {json.at("typical"),    json.at("loudest_tenth"), json.at("shared_by"),
          json.at("depth_step"), json.at("on_grid"),       json.at("on_lines")};
}

ordered_json json_of(const std::optional<NotSmoothed>& why) {
  return why ? ordered_json(kNotSmoothed[std::size_t(*why)]) : ordered_json();
}

static_assert(std::size_t(NotSmoothed::too_little_noise) + 1 == kNotSmoothed.size());

std::optional<NotSmoothed> not_smoothed_of(const ordered_json& json) {
  for (std::size_t i = 0; i < kNotSmoothed.size(); ++i)
    if (json == kNotSmoothed[i]) return NotSmoothed(i);
  return std::nullopt;
}

}  // namespace rfsmooth::pipeline::tiles
