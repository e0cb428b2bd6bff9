/// JSON files of jobs, statistics and options: read as a whole, with errors in plain words.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace rfsmooth::pipeline::io {

/// What a file holds. \throw Failure: input_unreadable (missing, a folder, no JSON; says the byte), usage (a
/// number beyond all that programs hold).
nlohmann::ordered_json read_json(const std::filesystem::path& path);

/// What is wrong with JSON that lacks something, or has something of another kind: "the key 'halo' is
/// missing".
std::string said_of(const nlohmann::json::exception& error);

}  // namespace rfsmooth::pipeline::io
