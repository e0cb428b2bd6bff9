/// Reading and writing clouds in the sub-commands: paths or "-", with the options they share.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <rfsmooth/denoise.h>

#include "pipeline/cli/files/file_options.h"
#include "pipeline/cli/jobs.h"
#include "pipeline/io/io.h"

namespace rfsmooth::cli {

/// Refuses an output that cannot be written, before any work. "-" always can. \throw Failure.
void check_target(const std::string& output, const FileOptions& options);

/// The same of a job, whose folder may be still to be made.
void check_target(const Job& job, const FileOptions& options);

/// Whether a path names a file in the folder that the job is still to make.
bool in_folder_to_come(const Job& job, const std::string& path);

/// The jobs of a sub-command. `makes`: the format of what it makes, unless --format says another; none: that
/// of the input. \throw Failure as plan_jobs.
std::vector<Job> plan_cloud_jobs(const std::vector<std::string>& arguments, const FileOptions& options,
                                 std::optional<pipeline::io::Format> makes = std::nullopt);

/// Refuses two outputs that are the same file, however they are spelled, or both standard output. Each is
/// what it is called ("OUT", "--report") and where it goes; devices, as /dev/null, take any number. \throw
/// Failure (usage).
void need_different_outputs(const std::vector<std::pair<std::string, std::string>>& outputs);

/// What an input is called in messages: its path, "standard input" for "-".
std::string name_of_input(const std::string& input);

/// Refuses standard input given twice: it is read once. \throw Failure (usage).
void need_one_standard_input(const std::vector<std::string>& inputs);

/// Reads a path, or standard input for "-", as stage "read". \throw Failure, also if the file is larger than
/// the available memory.
pipeline::io::Cloud load_cloud(const std::string& input, const Context& context);

/// Writes to a path, or to standard output for "-", as stage "write". \return in words what the format cannot
/// carry and --drop-unsupported left out. \throw Failure.
std::vector<std::string> store_cloud(const pipeline::io::Cloud& cloud, const std::string& output,
                                     const FileOptions& options, const Context& context);

/// Warns if rounding the coordinates to float32 has moved them by more than a twentieth of the spacing, noise
/// that denoise leaves alone. `xyz`: n x 3, the file's coordinates; ones with more digits than float32 are
/// not rounded. `spacing`: 0 if no two points differ, and then there is nothing to say. O(n).
void warn_if_coarse(const pipeline::io::Cloud& cloud, const std::vector<double>& xyz, double spacing,
                    const std::string& name, Console& console);

/// How a cloud will be written.
struct Target {
  pipeline::io::Format format;
  pipeline::io::Encoding encoding;
};

/// How what is made of `cloud` will be written. `makes`: the format of what is made; none: the cloud's own.
/// \throw Failure (usage) if that format has no such encoding.
Target target_of(const pipeline::io::Cloud& cloud, const std::string& output, const FileOptions& options,
                 std::optional<pipeline::io::Format> makes = std::nullopt);

/// The format that `output` will be written in.
pipeline::io::Format output_format(const pipeline::io::Cloud& cloud, const std::string& output,
                                   const FileOptions& options);

/// Format, encoding, points, organised size, fields, other elements and, of LAS, version, scale and records:
/// for reports and `info`.
nlohmann::ordered_json describe(const pipeline::io::Cloud& cloud);

/// The file options that change the output's bytes, for reports.
nlohmann::ordered_json bytes_options(const FileOptions& options);

}  // namespace rfsmooth::cli
