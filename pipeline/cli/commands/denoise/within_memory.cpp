#include "pipeline/cli/commands/denoise/within_memory.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <utility>

#include "base/fail.h"
#include "pipeline/cli/files/memory.h"
#include "pipeline/cli/options/text_values.h"
#include "pipeline/io/stream/atomic_file.h"
#include "pipeline/tiles/allowed.h"
#include "pipeline/tiles/in_one_process.h"

namespace rfsmooth::cli {

namespace {

/// \throw Failure (usage).
std::uint64_t bytes_of(const std::string& text) {
  std::string amount = text;
  std::transform(amount.begin(), amount.end(), amount.begin(),
                 [](unsigned char c) { return char(std::toupper(c)); });
  if (!amount.empty() && amount.back() == 'B') amount.pop_back();
  const double bytes = read_amount(amount).value_or(0);
  if (!(bytes >= 1e6) || !(bytes < 1e18))
    fail(ErrorCode::usage, "--memory takes at least a million bytes, as 8G, 8GB or 500M, not '{}'", text);
  return std::uint64_t(bytes);
}

/// Bytes that a cloud takes as a whole: `finite` points of a file of `bytes`.
std::uint64_t memory_of_whole(std::uint64_t finite, std::uint64_t bytes, bool normals) {
  constexpr std::uint64_t kMoreForNormals = 350;  // a point: 640 to 1230 in all on nine scans
  return rfsmooth::denoise_memory(std::size_t(finite)) + (normals ? kMoreForNormals * finite : 0) + bytes;
}

/// Whether the options ask for another format or encoding than the file's, which can be read in pieces.
bool asks_for_another_format(const FileOptions& files, pipeline::io::Format format) {
  using pipeline::io::Encoding;
  return (files.format && pipeline::io::format_by_name(*files.format) != format) ||
         (files.encoding &&
          pipeline::io::encoding_by_name(*files.encoding) != Encoding::binary_little_endian);
}

/// What the options ask for that is made of the whole cloud at once; empty: nothing.
std::string needs_whole_cloud(const DenoiseCommandOptions& options, pipeline::io::Format format) {
  const FileOptions& files = options.job.files;
  const std::pair<bool, const char*> needs[] = {{options.html.has_value(), "--html"},
                                                {options.strength_field.has_value(), "--strength-field"},
                                                {options.write_displacement, "--write-displacement"},
                                                {options.marks(), "--outliers mark"},
                                                {options.removes(), "--outliers remove"},
                                                {options.trace.trace.has_value(), "--trace"},
                                                {options.statistics.has_value(), "--statistics"},
                                                {options.job.run.report.has_value(), "--report"},
                                                {asks_for_another_format(files, format), "another format"}};
  for (const auto& [asked, name] : needs)
    if (asked) return name;
  return "";
}

/// A file that needs more memory than there is.
struct LargeFile {
  std::uint64_t finite = 0;  ///< points
  pipeline::io::Format format{};
};

/// The file, if it can be read in pieces and its cloud as a whole needs more than `most` bytes. What costs
/// little is looked at first: its size, then its header, then all of its rows.
std::optional<LargeFile> too_large(const std::string& input, std::uint64_t most, bool normals,
                                   const Context& context) {
  constexpr std::uint64_t kLeastRow = 3;  // bytes: three coordinates
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(input, error);
  const auto fits = [&](std::uint64_t points) { return memory_of_whole(points, bytes, normals) <= most; };
  if (error || fits(bytes / kLeastRow)) return std::nullopt;
  const auto file = pipeline::tiles::in_pieces(input, context);
  if (!file || fits(file->rows)) return std::nullopt;
  const std::uint64_t finite = pipeline::tiles::finite_rows(input, context);
  if (fits(finite)) return std::nullopt;
  return LargeFile{finite, file->format};
}

/// Refuses what cannot be done in tiles within `most` bytes. \throw Failure (usage).
void check_tiles(const DenoiseCommandOptions& options, const Job& job, const LargeFile& file,
                 std::uint64_t most) {
  if (const std::string what = needs_whole_cloud(options, file.format); !what.empty())
    fail(ErrorCode::usage, "{}: larger than --memory, and {} needs the whole cloud", job.input, what);
  pipeline::tiles::check_format(file.format, job.output);
  if (const std::uint64_t least = pipeline::tiles::least_memory(file.finite, options.normals.normals);
      most < least)
    fail(ErrorCode::usage, "{}: in tiles it takes --memory {:.0f}M or more", job.input,
         std::ceil(double(least) / 1e6));
}

/// Whether what is written goes into a file, beside which there is a place for tiles.
bool goes_into_file(const Job& job) {
  return job.output != "-" && pipeline::io::file_behind(job.output).has_value();
}

/// What would let a cloud that is smoothed as a whole go in tiles.
const char* way_into_tiles(const Job& job, const Context& context) {
  if (!pipeline::tiles::in_pieces(job.input, context))
    return "a single file of binary PLY (little-endian), binary PCD or LAS";
  return goes_into_file(job) ? "as the only input it" : "into a file it";
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
       "{}: needs about {:.0f} MB, --memory allows {:.0f} MB; {} would be smoothed in tiles", job.input,
       std::ceil(double(needed) / 1e6), double(most) / 1e6, way_into_tiles(job, context));
}

std::optional<std::uint64_t> memory_of_tiles(const DenoiseCommandOptions& options, const Job& job,
                                             const Context& context) {
  const std::optional<std::uint64_t> most = options.memory ? bytes_of(*options.memory) : available_memory();
  if (!most || job.input == "-" || !goes_into_file(job)) return std::nullopt;
  const auto large = too_large(job.input, *most, options.normals.normals, context);
  if (!large) return std::nullopt;
  const auto possible = guarded([&] {
    check_tiles(options, job, *large, *most);
    return *most;
  });
  // Without --memory nobody asked for tiles: the whole cloud is tried, and refused with both figures.
  if (!possible.ok() && !options.memory) return std::nullopt;
  return value_or_throw(possible);
}

}  // namespace rfsmooth::cli
