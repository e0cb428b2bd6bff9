#include "pipeline/cli/commands/denoise/within_memory.h"

#include <cmath>
#include <filesystem>
#include <utility>

#include "base/fail.h"
#include "pipeline/cli/files/memory.h"
#include "pipeline/cli/options/text_values.h"
#include "pipeline/tiles/allowed.h"
#include "pipeline/tiles/in_one_process.h"

namespace rfsmooth::cli {

namespace {

/// \throw Failure (usage).
std::uint64_t bytes_of(const std::string& text) {
  const double bytes = read_amount(text).value_or(0);
  if (!(bytes >= 1e6) || !(bytes < 1e18))
    fail(ErrorCode::usage, "--memory takes bytes, 8G or 500M say, not '{}'", text);
  return std::uint64_t(bytes);
}

/// Bytes that a cloud takes as a whole: `finite` points of a file of `bytes`.
std::uint64_t memory_of_whole(std::uint64_t finite, std::uint64_t bytes, bool normals) {
  constexpr std::uint64_t kMoreForNormals = 350;  // a point: 640 to 1230 in all on nine scans
  return rfsmooth::denoise_memory(std::size_t(finite)) + (normals ? kMoreForNormals * finite : 0) + bytes;
}

/// What the options ask for that is made of the whole cloud at once; empty: nothing.
std::string needs_whole_cloud(const DenoiseCommandOptions& options) {
  const FileOptions& files = options.job.files;
  const std::pair<bool, const char*> needs[] = {{options.html.has_value(), "--html"},
                                                {options.strength_field.has_value(), "--strength-field"},
                                                {options.write_displacement, "--write-displacement"},
                                                {options.marks(), "marked outliers"},
                                                {options.removes(), "--outliers remove"},
                                                {options.trace.trace.has_value(), "--trace"},
                                                {options.statistics.has_value(), "--statistics"},
                                                {options.job.run.report.has_value(), "--report"},
                                                {files.format || files.encoding, "another format"}};
  for (const auto& [asked, name] : needs)
    if (asked) return name;
  return "";
}

}  // namespace

void check_memory(const DenoiseCommandOptions& options, const Job& job, const std::vector<double>& xyz,
                  const Context& context) {
  if (!options.memory) return;
  const std::uint64_t most = bytes_of(*options.memory);
  std::error_code error;
  const std::uint64_t bytes = job.input == "-" ? 0 : std::filesystem::file_size(job.input, error),
                      needed = memory_of_whole(pipeline::io::finite_rows(xyz, context), error ? 0 : bytes,
                                               options.normals.normals);
  if (needed <= most) return;
  fail(ErrorCode::out_of_memory,
       "{}: needs about {:.0f} MB, --memory allows {:.0f} MB; a single file of binary PLY, binary PCD or LAS "
       "would be smoothed in tiles",
       job.input, std::ceil(double(needed) / 1e6), double(most) / 1e6);
}

std::optional<std::uint64_t> memory_of_tiles(const DenoiseCommandOptions& options, const Job& job,
                                             const Context& context) {
  const std::optional<std::uint64_t> asked =
      options.memory ? std::optional(bytes_of(*options.memory)) : std::nullopt;
  if (job.input == "-" || job.output == "-") return std::nullopt;
  const std::optional<std::size_t> there = available_memory();
  if (!asked && !there) return std::nullopt;
  const std::uint64_t most = asked ? *asked : std::uint64_t(*there);
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(job.input, error);
  constexpr std::uint64_t kLeastRow = 3;  // bytes: three coordinates
  const bool normals = options.normals.normals;
  if (error || memory_of_whole(bytes / kLeastRow, bytes, normals) <= most) return std::nullopt;
  const auto file = pipeline::tiles::in_pieces(job.input, context);
  if (!file || memory_of_whole(file->rows, bytes, normals) <= most) return std::nullopt;
  const std::uint64_t finite = pipeline::tiles::finite_rows(job.input, context);
  if (memory_of_whole(finite, bytes, normals) <= most) return std::nullopt;
  if (const std::string what = needs_whole_cloud(options); !what.empty()) {
    if (!asked) return std::nullopt;  // refused where the whole cloud is, with both figures
    fail(ErrorCode::usage, "{}: larger than --memory, and {} needs the whole cloud", job.input, what);
  }
  if (asked) pipeline::tiles::check_format(file->format, job.output);
  if (pipeline::io::format_of_extension(job.output).value_or(file->format) != file->format)
    return std::nullopt;
  if (const std::uint64_t least = pipeline::tiles::least_memory(finite, normals); most < least) {
    if (!asked) return std::nullopt;
    fail(ErrorCode::usage, "{}: in tiles it takes --memory {:.0f}M or more", job.input,
         std::ceil(double(least) / 1e6));
  }
  return most;
}

}  // namespace rfsmooth::cli
