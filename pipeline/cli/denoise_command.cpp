/// rfsmooth denoise: a cloud in, the same cloud without the noise out.
#include <memory>

#include <fmt/format.h>

#include "rfsmooth/pipeline/cli/cloud_files.h"
#include "rfsmooth/pipeline/cli/command.h"
#include "rfsmooth/pipeline/cli/console.h"
#include "rfsmooth/pipeline/cli/file_options.h"
#include "rfsmooth/pipeline/cli/jobs.h"
#include "rfsmooth/pipeline/cli/json_values.h"
#include "rfsmooth/pipeline/cli/memory.h"
#include "rfsmooth/pipeline/cli/report.h"
#include "rfsmooth/pipeline/denoise.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

struct Options {
  pipeline::DenoiseOptions denoise;
  FileOptions files;
  RunOptions run;
  TalkOptions talk;
};

ordered_json counts_of(const pipeline::DenoiseReport& report) {
  return {{"points", report.points},       {"finite", report.finite},   {"distinct", report.distinct},
          {"moved", report.moved},         {"faces", report.faces},     {"edges", report.edges},
          {"sdg_edges", report.sdg_edges}, {"bridges", report.bridges}, {"faceless", report.faceless},
          {"swaps", report.swaps}};
}

ordered_json options_of(pipeline::DenoiseOptions effective, const FileOptions& files) {
  std::vector<CommandOption> options;
  collect(effective, options);
  ordered_json object = json_object(options);
  object.update(bytes_options(files));
  return object;
}

/// "read 0.1 s, emst 0.4 s, ..."
std::string text_of(const std::vector<pipeline::StageTime>& stages) {
  std::string text;
  for (const auto& stage : stages)
    text += fmt::format("{}{} {:.2f} s", text.empty() ? "" : ", ", stage.name, stage.seconds);
  return text;
}

class DenoiseRun {
 public:
  DenoiseRun(const Options& options, Console& console, Report& report)
      : options_(options),
        console_(console),
        report_(report),
        context_(console.context(options.run.threads.value_or(0))) {}

  JobOutcome operator()(const Job& job) {
    ordered_json entry = {{"input", {{"path", job.input}}}, {"output", {{"path", job.output}}}};
    JobOutcome outcome;
    const auto done = guarded([&] { return denoise_file(job, entry); });
    if (done.ok()) {
      outcome.summary = done.value();
    } else {
      outcome.error = done.error();
      entry["error"] = {{"code", int(outcome.error->code)}, {"message", outcome.error->message}};
    }
    report_.add(std::move(entry));
    return outcome;
  }

 private:
  /// \return one line about it. \throw Failure.
  std::string denoise_file(const Job& job, ordered_json& entry) {
    check_target(job.output, options_.files);
    std::vector<pipeline::StageTime> stages;
    pipeline::io::Cloud cloud = load_cloud(job.input, context_, stages);
    entry["input"].update(describe(cloud));
    const std::size_t n = cloud.size();
    console_.set_points(n);
    if (const auto error = refuse_without_memory(job.input, pipeline::denoise_memory(n)))
      throw Failure(*error);

    std::vector<double> xyz = pipeline::io::positions(cloud, context_);
    auto result = pipeline::denoise(xyz.data(), n, options_.denoise, context_);
    if (!result.ok()) throw Failure({result.error().code, job.input + ": " + result.error().message});
    pipeline::DenoiseReport done = std::move(result).value();
    warn_about(job, cloud, done);
    pipeline::io::set_positions(cloud, xyz.data(), context_);
    stages.insert(stages.end(), done.seconds.begin(), done.seconds.end());
    store_cloud(cloud, job.output, options_.files, context_, stages);
    console_.say(fmt::format(
        "{} -> {}: {} points, {} finite; spacing {:.4g}; largest move {:.4g}, rms {:.4g}", job.input,
        job.output, done.points, done.finite, done.spacing, done.largest_move, done.rms_move));
    console_.say("seconds: " + text_of(stages));
    console_.detail(fmt::format("{} faces, {} edges, {} bridges, {} points without a face, {} swaps",
                                done.faces, done.edges, done.bridges, done.faceless, done.swaps));
    entry["options"] = options_of(done.effective, options_.files);
    entry["counts"] = counts_of(done);
    entry["spacing"] = done.spacing;
    entry["noise"] = done.noise;
    entry["largest_move"] = done.largest_move;
    entry["rms_move"] = done.rms_move;
    entry["threads"] = options_.run.threads ? ordered_json(*options_.run.threads) : ordered_json(nullptr);
    entry["seconds"] = json_of(stages);
    return fmt::format("{} points, largest move {:.4g}", done.points, done.largest_move);
  }

  void warn_about(const Job& job, const pipeline::io::Cloud& cloud, const pipeline::DenoiseReport& done) {
    if (done.finite < done.points)
      console_.detail(fmt::format("{}: {} points are not finite; they stay as they are", job.input,
                                  done.points - done.finite));
    if (done.moved > 0 && has_normals(cloud))
      console_.warn(fmt::format("{}: the normals are kept; they now describe the old positions", job.input));
  }

  const Options& options_;
  Console& console_;
  Report& report_;
  Context context_;
};

int run(const Options& options, const Invocation& typed) {
  // Wrong options are told before any file is touched.
  const auto valid = smoothing::complete(options.denoise.flow);
  if (!valid.ok()) throw Failure(valid.error());
  const std::vector<Job> jobs = plan_jobs(typed.arguments, options.files.output);
  need_free_stdout(jobs, options.run);
  Report report("denoise", options.run.report, options.files.force);
  Console console(options.talk);
  DenoiseRun denoise(options, console, report);
  const int code = run_jobs(jobs, console, std::ref(denoise));
  report.write();
  return code;
}

}  // namespace

Command denoise_command() {
  auto options = std::make_shared<Options>();
  Command command;
  command.name = "denoise";
  command.summary = "take the noise out of point clouds";
  command.usage = {"[options] IN OUT", "[options] IN... -o FOLDER/"};
  command.description =
      "Reads a cloud (PLY, PCD, XYZ; the format is found by content), connects its points to a rough mesh "
      "(EMST, SDG, RFS-mesh), smooths the mesh, and writes the same cloud with x, y, z replaced: every other "
      "field, the order and the number of points stay. Points that are not finite stay as they are.\n\n"
      "- stands for standard input or output; --format names the format where there is no extension. Without "
      "-o "
      "exactly two names are taken, IN and OUT; with -o every name is an input. Existing files are replaced "
      "only "
      "with --force.";
  collect(options->denoise, command.options);
  collect(options->files, command.options);
  collect(options->run, command.options);
  collect(options->talk, command.options);
  polish(command);
  command.run = [options](const Invocation& typed) { return run(*options, typed); };
  return command;
}

}  // namespace rfsmooth::cli
