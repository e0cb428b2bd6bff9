#include "pipeline/cli/console/trace_file.h"

#include <fmt/format.h>

#include "pipeline/io/io.h"

namespace rfsmooth::cli {

std::vector<FileBeside> TraceFile::files() const {
  if (!trace) return {};
  return {{"--trace", "trace", *trace}};
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
