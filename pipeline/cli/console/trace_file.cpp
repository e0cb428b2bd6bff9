#include "pipeline/cli/console/trace_file.h"

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/cli/own_files.h"
#include "pipeline/io/io.h"

namespace rfsmooth::cli {

void TraceFile::check(const FileOptions& files, const Invocation& typed) const {
  if (!trace) return;
  if (plan_cloud_jobs(typed.arguments, files).size() > 1)
    fail(ErrorCode::usage, "--trace is for one input; run the command once for each");
  check_no_cloud_target(*trace, files.force, "trace");
}

void TraceFile::write(const std::vector<TraceRow>& rows, const FileOptions& files) const {
  if (!trace) return;
  std::string text = "step,volume,area,energy,roughness,largest_move\n";
  for (const TraceRow& row : rows)
    text += fmt::format("{},{},{},{},{},{}\n", row.step, row.volume ? fmt::format("{}", *row.volume) : "",
                        row.area, row.energy, row.roughness, row.largest_move);
  value_or_throw(pipeline::io::write_bytes(text, *trace, files.force, {}));
}

}  // namespace rfsmooth::cli
