/// --trace: what the mesh measures after every step, as CSV.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <rfsmooth/flow.h>
#include <rfsmooth/options.h>

#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/files/file_options.h"

namespace rfsmooth::cli {

struct TraceFile {
  std::optional<std::string> trace;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(
        OptionInfo{"trace", "write volume, area, energy, roughness and largest move after every step, as CSV",
                   "file"},
        self.trace);
  }

  /// The file, if it was asked for.
  std::vector<FileBeside> files() const;

  /// The rows as CSV with a line of names; volume is empty for a mesh that is not closed. \throw Failure.
  void write(const std::vector<TraceRow>& rows, const FileOptions& files) const;
};

}  // namespace rfsmooth::cli
