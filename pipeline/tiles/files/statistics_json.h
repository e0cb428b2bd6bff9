/// Statistics as JSON: numbers with all their digits, so that what comes back is the same.
#pragma once

#include <nlohmann/json.hpp>

#include <rfsmooth/flow.h>
#include <rfsmooth/statistics.h>

namespace rfsmooth::pipeline::tiles {

/// Three numbers.
nlohmann::ordered_json json_of_place(const Eigen::Vector3d& p);
/// \throw nlohmann::json::exception where something is missing or of another kind.
Eigen::Vector3d place_of(const nlohmann::ordered_json& json);

/// Its two corners.
nlohmann::ordered_json json_of(const Statistics::Box& box);

/// \throw nlohmann::json::exception where something is missing or of another kind.
Statistics::Box box_of(const nlohmann::ordered_json& json);

/// What is there; the rest is left out.
nlohmann::ordered_json json_of(const Statistics& statistics);

/// \throw nlohmann::json::exception where something is missing or of another kind.
Statistics statistics_of(const nlohmann::ordered_json& json);

/// As reports tell it: lengths in world units.
nlohmann::ordered_json json_of(const NoiseSummary& noise);

/// The same read back. \throw nlohmann::json::exception where something is missing or of another kind.
NoiseSummary summary_of(const nlohmann::ordered_json& json);

/// A word; null for none.
nlohmann::ordered_json json_of(const std::optional<NotSmoothed>& why);

/// None for anything that is no such word.
std::optional<NotSmoothed> not_smoothed_of(const nlohmann::ordered_json& json);

}  // namespace rfsmooth::pipeline::tiles
