#include "pipeline/tiles/in_one_process.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <unistd.h>

#include "pipeline/io/stream/atomic_file.h"
#include "pipeline/tiles/row_file.h"

namespace rfsmooth::pipeline::tiles {

namespace fs = std::filesystem;

namespace {

/// A folder that is removed with all that is in it.
class PassingFolder {
 public:
  explicit PassingFolder(fs::path path) : path_(std::move(path)) {
    std::error_code error;
    if (!fs::create_directory(path_, error))
      throw Failure({ErrorCode::cannot_write, fmt::format("{}: cannot make the folder: {}", path_.string(),
                                                          error ? error.message() : "it exists")});
  }
  ~PassingFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  PassingFolder(const PassingFolder&) = delete;
  PassingFolder& operator=(const PassingFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Points at one place cannot be cut, and more of them than memory holds cannot be smoothed.
void check_sizes(const Job& job, const PlanOptions& how) {
  std::uint64_t most = 0;
  for (const Tile& tile : job.tiles) most = std::max(most, tile.points);
  constexpr std::uint64_t kUneven = 2;
  if (most > kUneven * how.tile_points)
    throw Failure({ErrorCode::out_of_memory,
                   fmt::format("not enough memory: {} points are at one place, and tiles may have {}", most,
                               how.tile_points)});
}

/// A context that reports its stages as the part [from, to] of the stage "tiles".
Context part_of(const Context& context, double from, double to) {
  Context part = context;
  part.progress = nullptr;
  if (context.progress)
    part.progress = [&context, from, to](std::string_view stage, double fraction) {
      const bool whole = stage == "plan" || stage == "join";  // others are many stages of one step
      return context.progress("tiles", whole ? from + (to - from) * fraction : from);
    };
  return part;
}

}  // namespace

PlanOptions plan_within(std::uint64_t memory, bool normals) {
  // At its peak a step takes some 700 bytes a point, records and all (denoise_memory), with normals 1000;
  // more where tiles are not square or not of even size. A square of n points has its halo on both sides; the
  // widest patches have 1600 points and a radius of sqrt(1600 / pi) where noise is below 2.7 spacings
  // (automatic.cpp).
  constexpr double kBytesPerPoint = 800, kBytesWithNormals = 1150, kHalos = 2 * kHaloRadii * 22.6,
                   kFewest = 20000;
  constexpr std::uint64_t kFixed = std::uint64_t{256} << 20;
  const double bytes = normals ? kBytesWithNormals : kBytesPerPoint;
  const double across = std::sqrt(double(std::max(memory, kFixed) - kFixed) / bytes) - kHalos;
  PlanOptions how;
  how.tile_points = std::uint64_t(std::max(kFewest, across * std::max(across, 0.0)));
  how.sample_points = std::min(how.sample_points, how.tile_points);
  return how;
}

std::optional<InPieces> in_pieces(const std::string& path, const Context& context) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  const auto file = guarded([&] {
    const RowFile rows(path, context);
    return InPieces{rows.rows(), rows.format()};
  });
  return file.ok() ? std::optional(file.value()) : std::nullopt;
}

Joined smooth_in_tiles(const std::string& input, const std::string& output, bool force, bool keep_scale,
                       const PlanOptions& how, const DenoiseOptions& options,
                       const std::optional<NormalsOptions>& normals, const Context& context) {
  constexpr double kPlan = 0.03, kSettled = 0.1, kJoin = 0.98;  // shares of the time, for the bar
  check_for_tiles(options);
  io::check_target(output, force);
  if (normals) RowFile(input, context).need_normals();  // refused before the work
  const fs::path target(output);
  const PassingFolder folder(target.parent_path() / fmt::format(".{}.tiles-{}",
                                                                target.filename().string().substr(0, 200),
                                                                ::getpid()));
  const Job job = plan_job({input}, folder.path(), how, nullptr, part_of(context, 0, kPlan));
  check_sizes(job, how);
  for (std::size_t t = 0; t < job.tiles.size(); ++t) measure_tile(job, t, part_of(context, kPlan, kPlan));
  settle_job(job, options, part_of(context, kPlan, kSettled));
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    const double each = (kJoin - kSettled) / double(job.tiles.size());
    run_tile(job, t, options, normals,
             part_of(context, kSettled + each * double(t), kSettled + each * double(t + 1)));
    context.report("tiles", kSettled + each * double(t + 1));
  }
  return join_job(job, {output}, force, keep_scale, normals.has_value(), part_of(context, kJoin, 1)).front();
}

}  // namespace rfsmooth::pipeline::tiles
