#include "pipeline/cli/files/cloud_jobs.h"

#include <sstream>

#include <fmt/format.h>

#include "base/stopwatch.h"
#include "pipeline/cli/console/report.h"
#include "pipeline/cli/exit_code.h"
#include "pipeline/cli/options/text_values.h"
#include "pipeline/cli/own_files.h"
#include "pipeline/io/convert/capacity.h"
#include "pipeline/io/convert/convert.h"
#include "pipeline/io/formats/las/las_plain.h"
#include "pipeline/io/json_file.h"
#include "pipeline/io/stream/atomic_file.h"

namespace rfsmooth::cli {

using nlohmann::ordered_json;

namespace {

/// "read 0.10 s, emst 0.40 s, ..."
std::string text_of(const std::vector<StageTime>& stages) {
  std::string text;
  for (const auto& stage : stages)
    text += fmt::format("{}{} {:.2f} s", text.empty() ? "" : ", ", stage.name, stage.seconds);
  return text;
}

/// What the input's file says of its cloud and what a file made anew goes without: of LAS all that no other
/// format has a place for, as the coordinate system; and what `work` could not take along.
std::vector<std::string> left_behind(const pipeline::io::Cloud& cloud, const OnCloud& on_cloud,
                                     const Context& context) {
  if (!on_cloud.makes) return {};
  std::vector<std::string> left;
  if (cloud.format == pipeline::io::Format::las) left = pipeline::io::las_losses(cloud);
  if (!on_cloud.will_lose) return left;
  const auto encoding = pipeline::io::target_encoding(cloud, *on_cloud.makes, std::nullopt);
  const auto more = on_cloud.will_lose(cloud, *on_cloud.makes, encoding, context);
  left.insert(left.end(), more.begin(), more.end());
  return left;
}

/// What an output is called in messages.
std::string name_of_output(const std::string& output) {
  return output == "-" ? "standard output" : output;
}

/// Refuses, before the work, an output whose format has no room for what is known to go there. \throw
/// Failure.
void need_room(const Job& job, const FileOptions& files, const OnCloud& on_cloud,
               const pipeline::io::Cloud& cloud, const Context& context) {
  pipeline::io::naming(name_of_output(job.output), [&] {
    const Target target = target_of(cloud, job.output, files, on_cloud.makes);
    if (on_cloud.will_lose && !files.drop_unsupported)
      pipeline::io::need_no_losses(on_cloud.will_lose(cloud, target.format, target.encoding, context),
                                   target.format, target.encoding);
    return Done{};
  });
}

/// "column 5 is displacement, 6 nx": those from column `first` on, where the file has no names that say so.
std::string unnamed_columns(const pipeline::io::Cloud& cloud, std::size_t first, const std::string& output,
                            pipeline::io::Format format) {
  using pipeline::io::Format;
  if (cloud.format != Format::xyz || format != Format::xyz || cloud.xyz_style.names ||
      pipeline::io::new_cells(cloud, output))
    return "";
  std::string said;
  for (std::size_t f = first; f < cloud.points().fields.size(); ++f)
    said += fmt::format(fmt::runtime(said.empty() ? "column {} is {}" : ", {} {}"), f + 1,
                        cloud.points().fields[f].name);
  return said;
}

void run_one(const Job& job, const JobOptions& options, const OnCloud& on_cloud, const Context& context,
             Console& console, ordered_json& entry, bool one_of_many) {
  need_own_target(job, options.files.output);
  check_target(job, options.files);
  std::vector<StageTime> stages;
  pipeline::io::Cloud cloud;
  {
    const Stopwatch watch(stages, "read");
    cloud = load_cloud(job.input, context);
  }
  entry["input"].update(describe(cloud));
  console.set_points(cloud.size());
  const std::size_t columns = cloud.points().fields.size();
  need_room(job, options.files, on_cloud, cloud, context);
  std::vector<std::string> dropped = left_behind(cloud, on_cloud, context);
  const std::string summary = pipeline::io::naming(name_of_input(job.input), [&] {
    return on_cloud.work(cloud, {job, context, console, stages, entry});
  });
  const pipeline::io::Format format = output_format(cloud, job.output, options.files);
  if (!job.folder.empty()) pipeline::io::make_folder(job.folder);
  {
    const Stopwatch watch(stages, "write");
    const auto more = pipeline::io::naming(
        name_of_output(job.output), [&] { return store_cloud(cloud, job.output, options.files, context); });
    dropped.insert(dropped.end(), more.begin(), more.end());
  }
  if (!dropped.empty()) {
    console.warn(fmt::format("{}: left out, as {} cannot carry them: {}", job.output,
                             pipeline::io::name_of(format), fmt::join(dropped, ", ")));
    entry["output"]["dropped"] = dropped;
  }
  tell_summary(job, summary, one_of_many, console);
  if (const auto added = unnamed_columns(cloud, columns, job.output, format); !added.empty())
    console.say(fmt::format("{}: has no names: {}", job.output, added));
  if (on_cloud.beside) on_cloud.beside(console);
  console.detail("seconds: " + text_of(stages));
  entry["threads"] = pipeline::io::or_null(options.console.threads);
  entry["seconds"] = json_of(stages);
}

/// Refuses, before any work, outputs that would take the place of each other, or of what must stay.
void check_outputs(const std::vector<Job>& jobs, const JobOptions& options, const OnCloud& on_cloud) {
  std::vector<FileBeside> beside;
  if (on_cloud.files_beside) beside = on_cloud.files_beside();
  std::vector<std::pair<std::string, std::string>> outputs;
  for (const Job& job : jobs) outputs.emplace_back("OUT", job.output);
  if (options.run.report) outputs.emplace_back("--report", *options.run.report);
  for (const FileBeside& file : beside) outputs.emplace_back(file.option, file.path);
  need_different_outputs(outputs);
  for (const FileBeside& file : beside)
    if (jobs.size() > 1)
      fail(ErrorCode::usage, "{} is for one input; run the command once for each", file.option);
  if (const auto& report = options.run.report; report && *report != "-")
    beside.push_back({"--report", "report", *report});
  for (const FileBeside& file : beside)
    if (!in_folder_to_come(jobs.front(), file.path))
      check_no_cloud_target(file.path, options.files.force, file.what);
}

}  // namespace

void tell_summary(const Job& job, const std::string& summary, bool one_of_many, Console& console) {
  std::vector<std::string> lines;
  std::istringstream text(summary);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  if (one_of_many && lines.size() > 1) lines = {lines[0] + "; " + lines[1]};
  lines[0] = fmt::format("{} -> {}: {}", job.input, job.output, lines[0]);
  for (const std::string& line : lines) console.say(line);
}

int run_cloud_jobs(const std::string& command, const JobOptions& options, const Invocation& typed,
                   const OnCloud& on_cloud) {
  on_cloud.check(typed);
  const std::vector<Job> jobs = plan_cloud_jobs(typed.arguments, options.files, on_cloud.makes);
  check_outputs(jobs, options, on_cloud);
  Report report(command, options.run.report, options.files.force);
  Console console(options.console);
  const Context context = console.context(on_cloud.stages());
  bool any_done = false;
  const int code = run_jobs(jobs, console, [&](const Job& job) {
    ordered_json entry = {{"input", {{"path", job.input}}}, {"output", {{"path", job.output}}}};
    const auto done = guarded([&] {
      run_one(job, options, on_cloud, context, console, entry, jobs.size() > 1);
      return Done{};
    });
    any_done = any_done || done.ok();
    std::optional<Error> error;
    if (!done.ok()) {
      error = Error{done.error().code, with_dashes(done.error().message)};
      entry["error"] = {{"code", exit_code(error->code)}, {"message", error->message}};
    }
    report.add(std::move(entry));
    return error;
  });
  if (code != exit_code(ErrorCode::cancelled)) report.write(any_done);
  return code;
}

}  // namespace rfsmooth::cli
