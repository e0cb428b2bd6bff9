/// rfsmooth denoise: a cloud in, the same cloud without the noise out.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/commands/denoise/summary.h"
#include "pipeline/cli/commands/denoise/within_memory.h"
#include "pipeline/cli/console/report.h"
#include "pipeline/cli/console/scale_said.h"
#include "pipeline/cli/files/constraint_fields.h"
#include "pipeline/cli/files/memory.h"
#include "pipeline/cli/other_program.h"
#include "pipeline/cli/own_files.h"
#include "pipeline/io/formats/las/las_scale.h"
#include "pipeline/io/point_fields.h"
#include "pipeline/page/page.h"
#include "pipeline/tiles/files/statistics_json.h"
#include "pipeline/tiles/in_one_process.h"
#include "pipeline/tiles/steps/settle.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

constexpr const char *kDisplacement = "displacement", *kOutlier = "outlier";

/// What is written beside the cloud, once that is there.
struct Beside {
  std::string command;  ///< that was typed
  std::string page;
  std::vector<TraceRow> trace;
};

void enter(const DenoiseReport& done, const DenoiseCommandOptions& options, ordered_json& entry) {
  DenoiseCommandOptions used = options;
  used.denoise = done.effective;
  used.html.reset();    // what is written beside the cloud is not how it was made
  used.memory.reset();  // nor is the memory it was made in
  entry["options"] = effective_options(used, options.job.files);
  entry["counts"] = {{"points", done.points},       {"finite", done.finite},    {"distinct", done.distinct},
                     {"moved", done.moved},         {"faces", done.faces},      {"edges", done.edges},
                     {"sdg_edges", done.sdg_edges}, {"bridges", done.bridges},  {"faceless", done.faceless},
                     {"swaps", done.swaps},         {"stranded", done.stranded}};
  entry["counts"]["outliers"] = done.outliers;
  entry["counts"]["removed"] = options.removes() ? done.outliers : 0;
  entry["spacing"] = done.spacing;
  entry["noise"] = done.noise;
  entry["noise_measured"] = pipeline::tiles::json_of(done.measured);
  entry["noise_left"] = done.noise_left;
  entry["not_smoothed"] = pipeline::tiles::json_of(done.not_smoothed);
  entry["guide_strength"] = done.guide_strength;
  entry["tail_times"] = done.tail_times;
  entry["equalized"] = {{"rms", done.equalized_rms}, {"largest", done.equalized_largest}};
  entry["largest_move"] = done.largest_move;
  entry["rms_move"] = done.rms_move;
}

void tell(const DenoiseReport& done, const DenoiseCommandOptions& options, const pipeline::io::Cloud& cloud,
          const CloudTask& task) {
  const bool as_las = output_format(cloud, task.job.output, options.job.files) == pipeline::io::Format::las;
  tell_points(done, options, pipeline::io::has_normals(cloud), as_las, task.job, task.console);
  task.console.detail(fmt::format("{} faces, {} edges, {} bridges, {} points without a face, {} swaps",
                                  done.faces, done.edges, done.bridges, done.faceless, done.swaps));
}

/// Fields that could not be added, told before the work. \throw Failure.
void check_fields(const DenoiseCommandOptions& options, const pipeline::io::Cloud& cloud) {
  if (options.write_displacement)
    pipeline::io::check_field(cloud, kDisplacement, pipeline::io::Scalar::float32);
  if (options.marks()) pipeline::io::check_field(cloud, kOutlier, pipeline::io::Scalar::uint8);
  check_normals(options.normals, cloud);
}

/// How far each point is from `before`, as the file now has it: rounded to the coordinates' own type. 0 for
/// points that are not finite.
void write_displacement(pipeline::io::Cloud& cloud, const std::vector<double>& before,
                        const Context& context) {
  const std::vector<double> after = pipeline::io::positions(cloud, context);
  std::vector<double> distance(cloud.size(), 0);
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const double moved = std::hypot(after[3 * i] - before[3 * i], after[3 * i + 1] - before[3 * i + 1],
                                    after[3 * i + 2] - before[3 * i + 2]);
    if (std::isfinite(moved)) distance[i] = moved;
  }
  pipeline::io::set_field(cloud, kDisplacement, pipeline::io::Scalar::float32, distance, context);
}

/// Drops the outliers, the others in their order. An organised cloud keeps its grid: there they become NaN,
/// as a sensor writes where it saw nothing (before `set_positions`, in `xyz`).
void remove_outliers(pipeline::io::Cloud& cloud, const std::vector<char>& outlier, const Context& context) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < outlier.size(); ++i)
    if (outlier[i] == 0) rows.push_back(i);
  pipeline::io::select_points(cloud, rows, context);
}

/// Refines the scale of a LAS cloud. For LAS to be written as far as it is coarse for what is left of the
/// noise. For other formats, which have no steps, as far as 32 bits go.
void refine_scale(const DenoiseCommandOptions& options, const DenoiseReport& done, pipeline::io::Cloud& cloud,
                  const double* xyz, const CloudTask& task) {
  using pipeline::io::Format;
  const auto& [job, context, console, stages, entry] = task;
  if (done.moved == 0 || cloud.format != Format::las) return;
  if (output_format(cloud, job.output, options.job.files) != Format::las) {
    pipeline::io::refine_scale(cloud, std::numeric_limits<double>::min(), xyz, context);
    return;
  }
  if (options.keep_scale || done.noise <= 0) return;
  const double step = pipeline::io::finest_needed(done.noise, done.noise_left);
  const pipeline::io::RefinedScale scale = pipeline::io::refine_scale(cloud, step, xyz, context);
  entry["scale"] = {{"before", scale.before}, {"after", scale.after}};
  tell_scale(job.input, scale, done.noise, done.noise_left, console);
}

bool keeps_grid(const pipeline::io::Cloud& cloud) {
  bool has_nan = cloud.organised();
  for (const std::size_t f : cloud.xyz) has_nan = has_nan && is_float(cloud.points().fields[f].type);
  return has_nan;
}

/// What --html shows of what became of the cloud; its normals only if they are of the new surface. Outliers
/// that are to be removed are still there: the page shows them on one side.
void page_after(const DenoiseReport& done, const DenoiseCommandOptions& options,
                const pipeline::io::Cloud& cloud, const Job& job, const Context& context,
                pipeline::PageContents& contents) {
  contents.after = pipeline::page_side(job.output, cloud, context);
  if (!options.normals.normals) contents.after.normals.clear();
  contents.outlier = done.outlier;
  for (std::size_t i = 0; options.removes() && i < done.outlier.size(); ++i)
    if (done.outlier[i] != 0) std::fill_n(&contents.after.xyz[3 * i], 3, std::nan(""));
  contents.figures = {{"outliers", std::to_string(done.outliers)},
                      {"spacing", fmt::format("{:.4g}", done.spacing)},
                      {"noise", fmt::format("{:.3g}", done.noise)}};
  if (done.noise_left < done.noise)
    contents.figures.emplace_back("about left of it", fmt::format("{:.3g}", done.noise_left));
}

std::string denoise_cloud(const DenoiseCommandOptions& options, Beside& beside, pipeline::io::Cloud& cloud,
                          const CloudTask& task) {
  const auto& [job, context, console, stages, entry] = task;
  const std::size_t n = cloud.size();
  check_fields(options, cloud);
  need_memory(job.input, rfsmooth::denoise_memory(n));
  std::vector<double> xyz = pipeline::io::positions(cloud, context);
  check_memory(options, job, xyz, context);
  const std::vector<double> strength =
      options.strength_field ? strengths(cloud, *options.strength_field, context) : std::vector<double>{};
  pipeline::PageContents page;
  if (options.html) page = pipeline::page_before(job.input, cloud, context);
  DenoiseOptions how = options.denoise;
  how.flow.trace = options.trace.trace.has_value();
  if (options.statistics)
    how.statistics = pipeline::tiles::read_settled(*options.statistics).report.statistics;
  DenoiseReport done = value_or_fail(rfsmooth::denoise(xyz.data(), n, how, context, strength), job.input);
  beside.trace = std::move(done.trace);
  const bool some_removed = options.removes() && done.outliers > 0,
             as_nan = some_removed && keeps_grid(cloud);
  const auto blank_outliers = [&] {
    for (std::size_t i = 0; i < n; ++i)
      if (done.outlier[i] != 0) std::fill_n(&xyz[3 * i], 3, std::numeric_limits<double>::quiet_NaN());
  };
  warn_if_coarse(cloud, pipeline::io::positions(cloud, context), done.spacing, job.input, console);
  if (as_nan) blank_outliers();
  refine_scale(options, done, cloud, xyz.data(), task);
  if (output_format(cloud, job.output, options.job.files) == pipeline::io::Format::las)
    warn_of_index(job.output, console);
  const std::vector<double> before =
      options.write_displacement ? pipeline::io::positions(cloud, context) : std::vector<double>{};
  pipeline::io::set_positions(cloud, xyz.data(), context);
  if (options.write_displacement) write_displacement(cloud, before, context);
  if (options.marks()) {
    std::vector<double> flags(done.outlier.begin(), done.outlier.end());
    flags.resize(n, 0);
    pipeline::io::set_field(cloud, kOutlier, pipeline::io::Scalar::uint8, flags, context);
  }
  stages.insert(stages.end(), done.seconds.begin(), done.seconds.end());
  tell(done, options, cloud, task);
  enter(done, options, entry);
  if (some_removed) blank_outliers();  // normals are of the points that stay
  write_normals(options.normals, cloud, xyz.data(), options.job.files, task);
  if (options.html) {
    page_after(done, options, cloud, job, context, page);
    page.command = beside.command;
    beside.page = pipeline::make_page(page, context);
  }
  if (some_removed && !as_nan) remove_outliers(cloud, done.outlier, context);
  return summary(done, options);
}

/// \throw Failure.
void write_beside(const DenoiseCommandOptions& options, const Beside& beside, Console& console) {
  options.trace.write(beside.trace, options.job.files);
  if (!options.html) return;
  value_or_throw(pipeline::io::write_bytes(beside.page, *options.html, options.job.files.force, {}));
  console.say(fmt::format("{}: open it in a browser", *options.html));
}

void check_denoise(const DenoiseCommandOptions& options, const Invocation& typed) {
  if (options.mark_outliers && options.denoise.outliers == Outliers::smooth)
    fail(ErrorCode::usage, "--mark-outliers has nothing to mark with --outliers smooth");
  check(options.normals);
  options.trace.check(options.job.files, typed);
  if (!options.html) return;
  if (plan_jobs(typed.arguments, options.job.files.output).size() > 1)
    fail(ErrorCode::usage, "--html shows one cloud; several are named");
  check_no_cloud_target(*options.html, options.job.files.force, "page");
}

/// One cloud in tiles. \return the exit code, or none if it is to be smoothed as a whole.
std::optional<int> denoise_in_tiles(const DenoiseCommandOptions& options, const Invocation& typed) {
  const std::vector<Job> jobs = plan_jobs(typed.arguments, options.job.files.output);
  if (jobs.size() != 1) return std::nullopt;
  const Job& job = jobs.front();
  Console console(options.job.talk);
  const Context context = console.context({{"tiles", 1}}, options.job.run.threads);
  const auto memory = memory_of_tiles(options, job, context);
  if (!memory) return std::nullopt;
  need_own_target(job, options.job.files.output);
  const pipeline::tiles::Within how = pipeline::tiles::plan_within(*memory, options.normals.normals);
  console.say(fmt::format("{}: too large for {:.3g} GB: smoothed in tiles of {} points", job.input,
                          double(*memory) / 1e9, how.plan.tile_points));
  const pipeline::tiles::SmoothedInTiles done = pipeline::tiles::smooth_in_tiles(
      job.input, job.output, options.job.files.force, options.keep_scale, how, options.denoise,
      normals_in_tiles(options.normals, {job.input}, context), context);
  tell_scale(job.input, done.joined.scale, done.report.noise, done.report.noise_left, console);
  if (done.joined.las) warn_of_index(job.output, console);
  mark_as_own(job.output);
  tell_points(done.report, options, done.had_normals, done.joined.las, job, console);
  tell_summary(job, summary(done.report, options), false, console);
  return 0;
}

}  // namespace

Command denoise_command() {
  auto options = std::make_shared<DenoiseCommandOptions>();
  Command command;
  command.name = "denoise";
  command.summary = "take the noise out of point clouds";
  command.usage = {"[options] IN OUT", "[options] IN... -o FOLDER"};
  command.description =
      "Reads a cloud (PLY, PCD, XYZ, LAS; the format is found by content), connects its points to a rough "
      "mesh (EMST, SDG, RFS-mesh), smooths the mesh, and writes the same cloud with x, y, z replaced: every "
      "other field, the order and the number of points stay. Points that are not finite stay as they are. "
      "Fields that are asked for (--write-displacement, --mark-outliers, --normals) come behind the "
      "points' other fields, or take the place of the one of that name.\n\n"
      "What is said of the noise beside its figure (the loudest tenth, shared by N neighbours, depth in "
      "steps) is explained by rfsmooth info --help.\n\n"
      "Outliers are points with no surface near. How many there are depends on the flow: the automatic one "
      "sees the tails of the noise, and a point that heavy tails explain is put onto the surface, is no "
      "outlier and is not removed; other flows look for no tails, and --outliers decides over it.\n\n"
      "- stands for standard input or output, and behind -- no word is an option. Where a name has no "
      "extension the format is that of the input, or of --format. Without -o exactly two names are taken, IN "
      "and OUT; with -o every name is an input. Existing files are replaced only with --force. Ctrl-C stops "
      "within a second and leaves no file; of several inputs those stay that were done before. A report, a "
      "page or a trace is written once its cloud is there, and not without one.";
  collect(*options, command.options);
  collect(options->job, command.options);
  command.everyday = {"strength", "noise",   "flow",   "outliers", "normals", "output",
                      "force",    "threads", "report", "quiet",    "verbose"};
  const auto beside = std::make_shared<Beside>();
  command.on_cloud = {[options](const Invocation& typed) { check_denoise(*options, typed); },
                      [options] { return denoising_stages(options->normals.normals); },
                      [options, beside](auto& cloud, const CloudTask& task) {
                        return denoise_cloud(*options, *beside, cloud, task);
                      },
                      [options, beside](Console& console) { write_beside(*options, *beside, console); }};
  command.run = [options, beside, on_cloud = command.on_cloud,
                 known = command.options](const Invocation& typed) {
    if (const auto tiled = denoise_in_tiles(*options, typed)) return *tiled;
    beside->command = command_line("denoise", typed, known);
    return run_cloud_jobs("denoise", options->job, typed, on_cloud);
  };
  return command;
}

}  // namespace rfsmooth::cli
