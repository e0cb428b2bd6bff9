/// JSON of jobs, statistics, options and reports: files are read as a whole, with errors in plain words.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace rfsmooth::pipeline::io {

/// What a file holds. \throw Failure: input_unreadable (missing, a folder, no JSON; says the byte), usage (a
/// number beyond all that programs hold).
nlohmann::ordered_json read_json(const std::filesystem::path& path);

/// What is wrong with JSON that lacks something, or has something of another kind: "the key 'halo' is
/// missing".
std::string said_of(const nlohmann::json::exception& error);

/// For people to read: a line for each key, and an end of the line behind all. What is no UTF-8, as names of
/// files need not be, is replaced.
std::string in_lines(const nlohmann::ordered_json& json);

/// Null where there is none.
template <class T>
nlohmann::ordered_json or_null(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

}  // namespace rfsmooth::pipeline::io
