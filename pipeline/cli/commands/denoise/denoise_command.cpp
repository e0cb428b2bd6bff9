/// rfsmooth denoise: a cloud in, the same cloud without the noise out.
#include <memory>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/commands/denoise/denoise_cloud.h"
#include "pipeline/cli/commands/denoise/summary.h"
#include "pipeline/cli/commands/denoise/within_memory.h"
#include "pipeline/cli/console/scale_said.h"
#include "pipeline/cli/other_program.h"
#include "pipeline/cli/own_files.h"
#include "pipeline/io/convert/convert.h"
#include "pipeline/tiles/in_one_process.h"

namespace rfsmooth::cli {

namespace {

/// \throw Failure.
void write_beside(const DenoiseCommandOptions& options, const Beside& beside, Console& console) {
  options.trace.write(beside.trace, options.job.files);
  if (!options.html) return;
  value_or_throw(pipeline::io::write_bytes(beside.page, *options.html, options.job.files.force, {}));
  console.say(fmt::format("{}: open it in a browser", *options.html));
}

/// The page and the trace, as far as they were asked for.
std::vector<FileBeside> files_beside(const DenoiseCommandOptions& options) {
  std::vector<FileBeside> files = options.trace.files();
  if (options.html) files.push_back({"--html", "page", *options.html});
  return files;
}

/// One cloud in tiles. \return the exit code, or none if it is to be smoothed as a whole.
std::optional<int> denoise_in_tiles(const DenoiseCommandOptions& options, const Invocation& typed) {
  check(options.normals);
  const std::vector<Job> jobs = plan_cloud_jobs(typed.arguments, options.job.files);
  if (jobs.size() != 1) return std::nullopt;
  const Job& job = jobs.front();
  Console console(options.job.console);
  const Context context = console.context({{"tiles", 1}});
  const auto memory = memory_of_tiles(options, job, context);
  if (!memory) return std::nullopt;
  need_own_target(job, options.job.files.output);
  const pipeline::tiles::Within how = pipeline::tiles::plan_within(*memory, options.normals.normals);
  console.say(fmt::format("{}: too large for {:.3g} GB: smoothed in tiles of {} points", job.input,
                          double(*memory) / 1e9, how.plan.tile_points));
  pipeline::tiles::SmoothedInTiles done = pipeline::tiles::smooth_in_tiles(
      {job.input,
       job.output,
       {options.job.files.force, options.keep_scale, options.normals.normals, job.folder}},
      how, options.denoise, normals_in_tiles(options.normals, {job.input}, context), context);
  const pipeline::io::RefinedScale& scale = done.joined.scale;
  tell_scale(job.input, scale, options.keep_scale, done.report.noise, done.report.noise_left, console);
  if (auto& left = done.report.noise_left) left = pipeline::io::with_rounding(*left, scale.coarsest());
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
      "Fields that are asked for (--write-displacement, --outliers mark, --normals) come behind the "
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
  command.options = collect(*options, options->job);
  command.everyday = {"strength", "noise",   "flow",   "outliers", "normals", "output",
                      "force",    "threads", "report", "quiet",    "verbose"};
  const auto beside = std::make_shared<Beside>();
  command.on_cloud = {[options](const Invocation&) { check(options->normals); },
                      [options] { return denoising_stages(options->normals.normals); },
                      [options, beside](auto& cloud, const CloudTask& task) {
                        return denoise_cloud(*options, *beside, cloud, task);
                      },
                      [options, beside](Console& console) { write_beside(*options, *beside, console); }};
  command.on_cloud.files_beside = [options] { return files_beside(*options); };
  command.on_cloud.will_lose = [options](const auto& cloud, Format format, Encoding encoding,
                                         const Context& context) {
    return pipeline::io::what_will_be_lost(cloud, added_fields(*options), format, encoding, context);
  };
  command.run = [options, beside, on_cloud = command.on_cloud,
                 known = command.options](const Invocation& typed) {
    if (const auto tiled = denoise_in_tiles(*options, typed)) return *tiled;
    beside->command = command_line("denoise", typed, known);
    return run_cloud_jobs("denoise", options->job, typed, on_cloud);
  };
  return command;
}

}  // namespace rfsmooth::cli
