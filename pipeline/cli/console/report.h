/// --report: what was done, as JSON. --config reads it and does the same again.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <rfsmooth/denoise.h>

namespace rfsmooth::cli {

class Report {
 public:
  Report(std::string command, const std::optional<std::string>& path, bool force);

  bool wanted() const { return !path_.empty(); }

  /// Adds the entry of one file; it should have "input", "output", "options", ...
  void add(nlohmann::ordered_json entry) { files_.push_back(std::move(entry)); }

  /// Writes the report: one file as an object, several under "files". If no job was done, there is no cloud
  /// for a file to stand beside, and in the way of the next run: then it goes to standard output only.
  /// \throw Failure (cannot_write).
  void write(bool any_done) const;

 private:
  std::string command_, path_;
  bool force_;
  nlohmann::ordered_json files_ = nlohmann::ordered_json::array();
};

nlohmann::ordered_json json_of(const std::vector<StageTime>& stages);

/// What there is to say of noise beside its figure, each after a comma: ", 3.4 in the loudest tenth, shared
/// by 4 neighbours, depth in steps". Nothing for even noise that each point has of its own.
std::string in_words(const NoiseSummary& noise);

/// "beside 1.99 that looks like small shape", if no noise could be told from as much; else nothing.
/// \param told what could be, \param measured with what could not
std::string beside_shape(double told, double measured, double spacing);

/// Whether points with such noise are as good as exact: there is nothing to say of it.
bool nearly_exact(double noise, double spacing);

}  // namespace rfsmooth::cli
