#include "pipeline/cli/console/report.h"

#include <fmt/format.h>

#include <rfsmooth/version.h>

#include "pipeline/io/io.h"
#include "pipeline/io/json_file.h"
#include "rfs_mesh/noise/noise_levels.h"

namespace rfsmooth::cli {

Report::Report(std::string command, const std::optional<std::string>& path, bool force)
    : command_(std::move(command)), path_(path.value_or("")), force_(force) {}

void Report::write(bool any_done) const {
  if (!wanted() || (path_ != "-" && !any_done)) return;
  nlohmann::ordered_json all = {{"rfsmooth", kVersion}, {"command", command_}};
  if (files_.size() == 1)
    all.update(files_[0]);
  else
    all["files"] = files_;
  const std::string text = pipeline::io::in_lines(all);
  if (path_ == "-")
    fmt::print("{}", text);
  else
    value_or_throw(pipeline::io::write_bytes(text, path_, force_, {}));
}

nlohmann::ordered_json json_of(const std::vector<StageTime>& stages) {
  auto object = nlohmann::ordered_json::object();
  for (const auto& stage : stages) object[stage.name] = stage.seconds;
  return object;
}

std::string in_words(const NoiseSummary& noise) {
  std::string words;
  if (noise.loudest > rfs_mesh::kSameNoise * noise.typical)
    words += fmt::format(", {:.3g} in the loudest tenth", noise.loudest);
  if (noise.shared >= 2) words += fmt::format(", shared by {:.0f} neighbours", noise.shared);
  if (noise.on_lines) words += ", points along lines";
  if (noise.step > 0)
    words += fmt::format(noise.on_grid ? ", points on a grid of {:.3g}" : ", depth in steps of {:.3g}",
                         noise.step);
  return words;
}

std::string beside_shape(double told, double measured, double spacing) {
  if (told > 0 || nearly_exact(measured, spacing)) return "";
  return fmt::format("beside {:.3g} that looks like small shape", measured);
}

bool nearly_exact(double noise, double spacing) {
  return noise < 0.002 * spacing;
}

}  // namespace rfsmooth::cli
