#include "pipeline/cli/files/cloud_jobs.h"

#include <fmt/format.h>

#include "pipeline/cli/report.h"

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

std::string run_one(const Job& job, const JobOptions& options, const CloudWork& work, const Context& context,
                    Console& console, ordered_json& entry) {
  check_target(job.output, options.files);
  std::vector<StageTime> stages;
  pipeline::io::Cloud cloud = load_cloud(job.input, context, stages);
  entry["input"].update(describe(cloud));
  console.set_points(cloud.size());
  std::string summary = work(cloud, job, context, console, stages, entry);
  store_cloud(cloud, job.output, options.files, context, stages);
  console.say(fmt::format("{} -> {}: {}", job.input, job.output, summary));
  console.say("seconds: " + text_of(stages));
  entry["threads"] = options.run.threads ? ordered_json(*options.run.threads) : ordered_json(nullptr);
  entry["seconds"] = json_of(stages);
  return summary;
}

}  // namespace

int run_cloud_jobs(const std::string& command, const JobOptions& options, const Invocation& typed,
                   const CloudWork& work) {
  const std::vector<Job> jobs = plan_jobs(typed.arguments, options.files.output);
  need_free_stdout(jobs, options.run);
  Report report(command, options.run.report, options.files.force);
  Console console(options.talk);
  const Context context = console.context(options.run.threads.value_or(0));
  const int code = run_jobs(jobs, console, [&](const Job& job) {
    ordered_json entry = {{"input", {{"path", job.input}}}, {"output", {{"path", job.output}}}};
    JobOutcome outcome;
    const auto done = guarded([&] { return run_one(job, options, work, context, console, entry); });
    if (done.ok()) {
      outcome.summary = done.value();
    } else {
      outcome.error = done.error();
      entry["error"] = {{"code", int(outcome.error->code)}, {"message", outcome.error->message}};
    }
    report.add(std::move(entry));
    return outcome;
  });
  report.write();
  return code;
}

}  // namespace rfsmooth::cli
