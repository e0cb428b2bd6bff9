/// Clouds in and out for the sub-commands: paths or "-", with the options they share.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <rfsmooth/denoise.h>

#include "pipeline/cli/files/file_options.h"
#include "pipeline/cli/jobs.h"
#include "pipeline/io/io.h"

namespace rfsmooth::cli {

/// Refuses, before any work, an output that could not be written. \throw Failure.
void check_target(const std::string& output, const FileOptions& options);

/// At most one thing may go to standard output, and --report - counts. \throw Failure (usage).
void need_free_stdout(const std::vector<Job>& jobs, const RunOptions& options);

/// Reads a path, or standard input for "-"; adds a stage "read". Refuses a file larger than the memory there
/// is. \throw Failure.
pipeline::io::Cloud load_cloud(const std::string& input, const Context& context,
                               std::vector<StageTime>& stages);

/// Writes to a path, or to standard output for "-"; adds a stage "write". \throw Failure.
void store_cloud(const pipeline::io::Cloud& cloud, const std::string& output, const FileOptions& options,
                 const Context& context, std::vector<StageTime>& stages);

/// Whether the points have nx, ny, nz or normal_x, ...
bool has_normals(const pipeline::io::Cloud& cloud);

/// Warns where float32 cannot hold the coordinates' spacing: where rounding them is more than the noise that
/// denoise lets be, a twentieth of the spacing. `xyz`: what the file holds. O(n).
void warn_if_coarse(const pipeline::io::Cloud& cloud, const std::vector<double>& xyz, double spacing,
                    const std::string& name, Console& console);

/// The format that `output` will be written in.
pipeline::io::Format output_format(const pipeline::io::Cloud& cloud, const std::string& output,
                                   const FileOptions& options);

/// Format, encoding, points, organised size and fields, for reports and `info`.
nlohmann::ordered_json describe(const pipeline::io::Cloud& cloud);

/// The file options that change the output's bytes, for reports.
nlohmann::ordered_json bytes_options(const FileOptions& options);

}  // namespace rfsmooth::cli
