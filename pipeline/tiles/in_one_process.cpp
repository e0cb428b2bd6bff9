#include "pipeline/tiles/in_one_process.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <unistd.h>

#include "base/fail.h"
#include "pipeline/io/stream/atomic_file.h"
#include "pipeline/tiles/allowed.h"
#include "pipeline/tiles/files/row_file.h"
#include "pipeline/tiles/halo.h"
#include "pipeline/tiles/steps/measure.h"
#include "pipeline/tiles/steps/plan.h"
#include "pipeline/tiles/steps/run.h"
#include "pipeline/tiles/steps/settle.h"
#include "pipeline/tiles/steps/status.h"

namespace rfsmooth::pipeline::tiles {

namespace fs = std::filesystem;

namespace {

/// A folder that is removed with all that is in it.
class PassingFolder {
 public:
  explicit PassingFolder(fs::path path) : path_(std::move(path)) {
    std::error_code error;
    if (!fs::create_directory(path_, error))
      fail(ErrorCode::cannot_write, "{}: cannot make the folder: {}", path_.string(),
           error ? error.message() : "it exists");
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

// At its peak a cloud takes 380 to 920 bytes a point on nine scans, as denoise_memory has it, with normals
// 640 to 1230.
double bytes_a_point(bool normals) {
  constexpr double kBytesPerPoint = 950, kBytesWithNormals = 1300;
  return normals ? kBytesWithNormals : kBytesPerPoint;
}

constexpr std::uint64_t kFixed = std::uint64_t{24} << 20;
constexpr double kFewest = 3000;        // points of a tile: fewer are not worth what lies around them
constexpr double kLeastPoints = 50000;  // a tile with what the usual noise asks for around it

/// Halves the tiles that are too many points with what lies around them, as far as that is worth it. Points
/// at one place cannot be cut: more of them than memory holds are refused.
void split_large(Job& job, const Within& how, const Context& context) {
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    bool cut = true;
    const auto is_large = [&] {
      const std::uint64_t points = job.tiles[t].points;
      return double(points) >= 2 * kFewest &&
             (points > how.most || points_with_halo(job, t, context) > how.most);
    };
    while (cut && is_large()) cut = split_tile(job, t, context);
    if (!cut && job.tiles[t].points > how.most)
      fail(ErrorCode::out_of_memory, "not enough memory: {} points are at one place, and tiles may have {}",
           job.tiles[t].points, how.most);
  }
}

}  // namespace

Within plan_within(std::uint64_t memory, bool normals) {
  // A square of n points has its halo on both sides; the widest patches have 1600 points and a radius of
  // sqrt(1600 / pi) where noise is below 2.7 spacings (automatic.cpp).
  constexpr double kHalos = 2 * kHaloRadii * 22.6;
  Within how;
  how.most = std::max(memory, kFixed) - kFixed;
  how.most = std::uint64_t(double(how.most) / bytes_a_point(normals));
  const double across = std::sqrt(double(how.most)) - kHalos;
  how.plan.tile_points = std::uint64_t(std::max(kFewest, across * std::max(across, 0.0)));
  how.plan.sample_points = std::min(how.plan.sample_points, std::max<std::uint64_t>(1, how.most));
  return how;
}

std::uint64_t least_memory(std::uint64_t points, bool normals) {
  constexpr double kStep = 1.05;
  double memory = double(kFixed) + kLeastPoints * bytes_a_point(normals);
  // Joining has a buffer of 32 KB for each tile, and another one for its normals.
  const auto joining = [&] {
    const double tiles =
        1 + 2 * double(points) / double(plan_within(std::uint64_t(memory), normals).plan.tile_points);
    return double(kFixed) + tiles * (normals ? 73728 : 32768);
  };
  while (joining() > memory) memory *= kStep;
  return std::uint64_t(memory);
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

std::uint64_t finite_rows(const std::string& path, const Context& context) {
  const RowFile file(path, context);
  std::uint64_t finite = 0;
  file.for_each_piece(context, [&](std::uint64_t, std::size_t count, const io::Bytes& rows) {
    for (std::size_t i = 0; i < count; ++i) finite += std::uint64_t(file.get(rows, i).allFinite());
  });
  return finite;
}

SmoothedInTiles smooth_in_tiles(const TiledRun& run, const Within& how, const DenoiseOptions& options,
                                const std::optional<NormalsOptions>& normals, const Context& context) {
  constexpr double kPlan = 0.03, kSettled = 0.1, kJoin = 0.98;  // shares of the time, for the bar
  check_for_tiles(options);
  SmoothedInTiles done;
  RowFile file(run.input, context);
  done.had_normals = file.has_normals();
  if (normals) file.need_normals();  // refused before the work
  if (!run.join.folder.empty()) io::make_folder(run.join.folder);
  io::check_target(run.output, run.join.force);
  const auto target = io::file_behind(run.output);
  if (!target) fail(ErrorCode::usage, "{}: in tiles the output is a file", run.output);
  const PassingFolder folder(target->parent_path() / fmt::format(".{}.tiles-{}",
                                                                 target->filename().string().substr(0, 200),
                                                                 ::getpid()));
  Job job = plan_job({run.input}, folder.path(), how.plan, nullptr, part_of(context, 0, kPlan));
  for (std::size_t t = 0; t < job.tiles.size(); ++t) measure_tile(job, t, part_of(context, kPlan, kPlan));
  settle_job(job, options, part_of(context, kPlan, kSettled));
  split_large(job, how, part_of(context, kSettled, kSettled));
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    const double each = (kJoin - kSettled) / double(job.tiles.size());
    run_tile(job, t, options, normals,
             part_of(context, kSettled + each * double(t), kSettled + each * double(t + 1)), how.most);
    context.report("tiles", kSettled + each * double(t + 1));
  }
  done.report = report_of(job, options);
  JoinOptions join = run.join;
  join.normals = normals.has_value();
  done.joined = join_job(job, {run.output}, join, part_of(context, kJoin, 1)).front();
  return done;
}

}  // namespace rfsmooth::pipeline::tiles
