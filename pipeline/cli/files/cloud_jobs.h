/// What sub-commands that turn a cloud into a file share: options, the loop over files, the report.
#pragma once

#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/console/console.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/cli/options/json_values.h"

namespace rfsmooth::cli {

struct JobOptions {
  FileOptions files;
  RunOptions run;
  ConsoleOptions console;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    FileOptions::describe(self.files, visit);
    RunOptions::describe(self.run, visit);
    ConsoleOptions::describe(self.console, visit);
  }
};

/// Says what became of a job, in lines; of one of many the first two, as one.
void tell_summary(const Job& job, const std::string& summary, bool one_of_many, Console& console);

/// Checks the options and plans the jobs, then for each: reads, works, writes, reports. \return the exit
/// code.
int run_cloud_jobs(const std::string& command, const JobOptions& options, const Invocation& typed,
                   const OnCloud& on_cloud);

/// The options that were used, as the report shows them; --config takes them back.
template <class Options>
nlohmann::ordered_json effective_options(Options used, const FileOptions& files) {
  nlohmann::ordered_json object = json_object(collect(used));
  object.update(bytes_options(files));
  return object;
}

}  // namespace rfsmooth::cli
