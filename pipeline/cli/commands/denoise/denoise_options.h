/// The options of rfsmooth denoise.
#pragma once

#include <optional>
#include <string>

#include <rfsmooth/denoise.h>

#include "pipeline/cli/console/trace_file.h"
#include "pipeline/cli/files/cloud_jobs.h"
#include "pipeline/cli/files/cloud_normals.h"

namespace rfsmooth::cli {

struct DenoiseCommandOptions {
  DenoiseOptions denoise;
  std::optional<std::string> strength_field;
  bool write_displacement = false;
  bool keep_scale = false;
  std::optional<std::string> html;
  std::optional<std::string> memory, statistics;
  NormalsFields normals;
  TraceFile trace;
  JobOptions job;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    DenoiseOptions::describe(self.denoise, visit);
    visit(OptionInfo{"strength-field", "field in [0, 1] of the input: 0 stays, 1 is smoothed fully", ""},
          self.strength_field);
    visit(OptionInfo{"write-displacement", "add a field 'displacement': how far each point moved", ""},
          self.write_displacement);
    visit(
        OptionInfo{
            "keep-scale",
            "LAS: keep the scale of the file, also where its steps are coarser than half of the noise left",
            ""},
        self.keep_scale);
    visit(OptionInfo{"html", "a page to look at what was done, for browsers (see report); of one input",
                     "file"},
          self.html);
    visit(OptionInfo{"memory",
                     "take no more than that (8G, 500M): larger clouds are smoothed in tiles, on the disk of "
                     "the output; auto: what the machine has",
                     ""},
          self.memory);
    visit(OptionInfo{"statistics",
                     "what the cloud as a whole is like, as 'rfsmooth tiles settle' wrote it, instead of "
                     "measuring it: the result in tiles is like that but for the seams",
                     "file"},
          self.statistics);
    NormalsFields::describe(self.normals, visit);
    TraceFile::describe(self.trace, visit);
  }

  bool marks() const { return denoise.outliers == Outliers::mark; }
  bool removes() const { return denoise.outliers == Outliers::remove; }
};

}  // namespace rfsmooth::cli
