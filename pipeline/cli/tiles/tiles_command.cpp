/// rfsmooth tiles: a cloud larger than memory, or than a machine, step by step in a folder.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/console/console.h"
#include "pipeline/cli/console/scale_said.h"
#include "pipeline/cli/exit_code.h"
#include "pipeline/cli/files/cloud_normals.h"
#include "pipeline/cli/files/file_options.h"
#include "pipeline/cli/jobs.h"
#include "pipeline/cli/options/json_values.h"
#include "pipeline/cli/options/text_values.h"
#include "pipeline/cli/own_files.h"
#include "pipeline/io/io.h"
#include "pipeline/io/json_file.h"
#include "pipeline/io/stream/atomic_file.h"
#include "pipeline/tiles/allowed.h"
#include "pipeline/tiles/files/row_file.h"
#include "pipeline/tiles/job.h"
#include "pipeline/tiles/steps/join.h"
#include "pipeline/tiles/steps/measure.h"
#include "pipeline/tiles/steps/plan.h"
#include "pipeline/tiles/steps/run.h"
#include "pipeline/tiles/steps/settle.h"
#include "pipeline/tiles/steps/status.h"

namespace rfsmooth::cli {

namespace {

using pipeline::tiles::Job;

/// What the plan keeps for all steps.
struct PlannedOptions {
  DenoiseOptions denoise;
  NormalsFields normals;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    NormalsFields::describe(self.normals, visit);
    DenoiseOptions::describe(self.denoise, visit);
  }
};

struct TilesOptions {
  PlannedOptions planned;
  int tile_points = 5'000'000, sample_points = 1'000'000;
  bool json = false, force = false, keep_scale = false;
  ConsoleOptions console;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"tile-points", "plan: most points of a tile, without what lies around it", "points", 1,
                     1e9},
          self.tile_points);
    visit(OptionInfo{"sample-points", "plan: points that tell what the whole cloud is like", "points", 1000,
                     1e9},
          self.sample_points);
    visit(OptionInfo{"json", "status: print JSON", ""}, self.json);
    visit(OptionInfo{"force", "join: replace existing files", ""}, self.force);
    visit(
        OptionInfo{"keep-scale",
                   "join: keep the scales of LAS files, also where their steps are coarser than half of the "
                   "noise left",
                   ""},
        self.keep_scale);
    ConsoleOptions::describe(self.console, visit);
    PlannedOptions::describe(self.planned, visit);
  }
};

/// The options that the plan was made with.
PlannedOptions planned_options(const Job& job) {
  PlannedOptions planned;
  const std::vector<CommandOption> bound = collect(planned);
  for (const CommandOption& option : bound) {
    const auto value = job.options.find(option.name);
    if (value == job.options.end()) continue;
    if (value->is_null() && !option.optional) continue;
    if (const auto text = typed_text(*value)) assign(option, *text);
  }
  for (const CommandOption& option : bound)
    if (option.finish) option.finish();
  return planned;
}

std::size_t tile_number(const std::string& text) {
  const auto tile = read_integer(text);
  if (!tile || *tile < 0) fail(ErrorCode::usage, "'{}' is no number of a tile", text);
  return std::size_t(*tile);
}

/// Refuses inputs whose fields cannot take normals, which join would write. \throw Failure (usage).
void need_room_for_normals(const std::vector<std::string>& inputs, const Context& context) {
  for (const std::string& input : inputs)
    pipeline::io::naming(input, [&] {
      pipeline::tiles::RowFile(input, context).need_normals();
      return Done{};
    });
}

void plan_tiles(TilesOptions& options, const std::vector<std::string>& arguments, const Context& context,
                Console& console) {
  if (arguments.size() < 2) fail(ErrorCode::usage, "rfsmooth tiles plan takes IN... JOB");
  const Outliers outliers = options.planned.denoise.outliers;
  if (outliers == Outliers::mark || outliers == Outliers::remove)
    fail(ErrorCode::usage, "in tiles outliers are kept or smoothed: every row stays, and no field is added");
  pipeline::tiles::check_for_tiles(options.planned.denoise);
  const std::vector<std::string> inputs(arguments.begin(), arguments.end() - 1);
  if (inputs.size() > 1) jobs_in_folder(inputs, "OUT");  // as join will write them
  NormalsFields& normals = options.planned.normals;
  check(normals);
  if (normals.normals) need_room_for_normals(inputs, context);
  if (const auto how = normals_in_tiles(normals, inputs, context); how && how->viewpoint)
    normals.viewpoint = to_text(*how->viewpoint);
  const Job job = pipeline::tiles::plan_job(
      inputs, arguments.back(), {std::uint64_t(options.tile_points), std::uint64_t(options.sample_points)},
      json_object(collect(options.planned)), context);
  console.say(fmt::format("{}: {} in {}", arguments.back(), counted(job.points, "point"),
                          counted(job.tiles.size(), "tile")));
}

/// Where the inputs of a job go, which is refused, before any work, if something must not be replaced. Pieces
/// are written to a name: "-" becomes that of standard output.
std::vector<cli::Job> outputs_of(const std::vector<std::string>& inputs, const std::string& out, bool force) {
  std::vector<cli::Job> files = plan_jobs(inputs, out);
  for (cli::Job& file : files) {
    if (file.output == "-") file.output = "/dev/stdout";
    need_own_target(inputs, file.output);
    if (file.folder.empty()) pipeline::io::check_target(file.output, force);
  }
  return files;
}

/// \return the exit code.
int join_tiles(const TilesOptions& options, const std::vector<std::string>& arguments, const Context& context,
               Console& console) {
  if (arguments.size() != 2) fail(ErrorCode::usage, "rfsmooth tiles join takes JOB OUT");
  const Job job = pipeline::tiles::open_job(arguments[0]);
  std::vector<std::string> inputs, outputs;
  for (const auto& input : job.inputs) inputs.push_back(input.path);
  const std::vector<cli::Job> files = outputs_of(inputs, arguments[1], options.force);
  for (const cli::Job& file : files) outputs.push_back(file.output);
  auto done = guarded([&] {
    return pipeline::tiles::join_job(
        job, outputs,
        {options.force, options.keep_scale, planned_options(job).normals.normals, files.front().folder},
        context);
  });
  const bool to_reader = arguments[1] == "-" && !done.ok() && done.error().code == ErrorCode::cannot_write;
  if (to_reader && stdout_reader_is_gone()) return exit_code(ErrorCode::cannot_write);  // it has seen enough
  const auto joined = value_or_throw(std::move(done));
  const DenoiseReport settled = pipeline::tiles::settled_of(job).report;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    tell_scale(job.inputs[i].path, joined[i].scale, options.keep_scale, settled.noise, settled.noise_left,
               console);
    if (joined[i].las) warn_of_index(outputs[i], console);
    mark_as_own(outputs[i]);
  }
  console.say(
      fmt::format("{}: {}, {}", arguments[1], counted(job.points, "point"), counted(outputs.size(), "file")));
  return 0;
}

void tell_status(const TilesOptions& options, const std::vector<std::string>& arguments,
                 const Context& context) {
  if (arguments.size() != 1) fail(ErrorCode::usage, "rfsmooth tiles status takes JOB");
  const auto s = pipeline::tiles::job_status(pipeline::tiles::open_job(arguments[0]), context);
  if (options.json)
    fmt::print("{}", pipeline::io::in_lines({{"points", s.points},
                                             {"tiles", s.tiles},
                                             {"measured", s.measured},
                                             {"settled", s.settled},
                                             {"halo", s.halo},
                                             {"run", s.run},
                                             {"halo_share", s.halo_share},
                                             {"seconds", s.seconds},
                                             {"missing", s.missing}}));
  else
    fmt::print("{} in {}: {} measured, {}settled, {} run{}\n", counted(s.points, "point"),
               counted(s.tiles, "tile"), s.measured, s.settled ? "" : "not ", s.run,
               s.run == 0
                   ? ""
                   : fmt::format(" in {:.3g} s of processor time, with {:.0f} % more points around them",
                                 s.seconds, 100 * s.halo_share));
}

/// `measure`, `settle` and `run`.
void work_on_tiles(const std::string& step, const std::vector<std::string>& arguments,
                   const Context& context) {
  if (arguments.empty() || (step == "settle") != (arguments.size() == 1))
    fail(ErrorCode::usage, "rfsmooth tiles {} takes JOB{}", step, step == "settle" ? "" : " TILE...");
  const Job job = pipeline::tiles::open_job(arguments[0]);
  const PlannedOptions planned = planned_options(job);
  if (step == "settle") return pipeline::tiles::settle_job(job, planned.denoise, context);
  std::optional<NormalsOptions> normals;
  if (planned.normals.normals) normals = NormalsOptions{typed_viewpoint(planned.normals.viewpoint)};
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::size_t tile = tile_number(arguments[i]);
    if (step == "measure")
      pipeline::tiles::measure_tile(job, tile, context);
    else
      pipeline::tiles::run_tile(job, tile, planned.denoise, normals, context);
  }
}

/// The words that come first.
std::vector<std::string> steps_of_tiles() {
  return {"plan", "measure", "settle", "run", "join", "status"};
}

int run_tiles(TilesOptions& options, const Invocation& typed) {
  const std::vector<std::string> steps = steps_of_tiles();
  const std::string step = typed.arguments.empty() ? "" : typed.arguments.front();
  if (std::find(steps.begin(), steps.end(), step) == steps.end())
    fail(ErrorCode::usage, "rfsmooth tiles takes one of {}", fmt::join(steps, ", "));
  if (step != "plan") {
    PlannedOptions unused;
    const std::vector<CommandOption> planned = collect(unused);
    for (const auto& [name, text] : typed.options)
      if (find_option(planned, name) != nullptr)
        fail(ErrorCode::usage, "--{} is for rfsmooth tiles plan; the other steps take it from there", name);
  }
  const std::vector<std::string> arguments(typed.arguments.begin() + 1, typed.arguments.end());
  Console console(options.console);
  std::vector<StageShare> stages = denoising_stages(false);
  if (step == "plan") stages = {{"plan", 1}};
  if (step == "join") stages = {{"join", 1}};
  const Context context = console.context(stages);
  if (step == "plan")
    plan_tiles(options, arguments, context, console);
  else if (step == "join")
    return join_tiles(options, arguments, context, console);
  else if (step == "status")
    tell_status(options, arguments, context);
  else
    work_on_tiles(step, arguments, context);
  return 0;
}

}  // namespace

Command tiles_command() {
  auto options = std::make_shared<TilesOptions>();
  Command command;
  command.name = "tiles";
  command.summary = "take the noise out of clouds larger than memory, tile by tile";
  command.usage = {"plan [options] IN... JOB", "measure JOB TILE...", "settle JOB",
                   "run JOB TILE...",          "join JOB OUT",        "status JOB [--json]"};
  command.description =
      "Smooths a cloud (binary PLY, binary PCD or LAS, one file or many that are one cloud) in tiles, in a "
      "folder JOB. plan cuts it; measure, for every tile, takes a sample; settle finds from it what the "
      "cloud as a whole is like; run, for every tile, smooths it; join writes the files with x, y, z "
      "replaced (many into a folder, also OUT/; a single one also to standard output, -). "
      "Tiles are numbered from 0; measure and run may go on in any order, in any number of processes, and "
      "again: what is there complete is not made again. The same inputs give the same bytes. On one machine "
      "'rfsmooth denoise --memory 8G IN OUT' does all of it.";
  command.options = collect(*options);
  command.first_words = steps_of_tiles();
  command.everyday = {"tile-points", "sample-points", "strength", "noise",
                      "threads",     "json",          "force",    "quiet"};
  command.run = [options](const Invocation& typed) { return run_tiles(*options, typed); };
  return command;
}

}  // namespace rfsmooth::cli
