/// Normals of the smoothed surface for the sub-commands: which fields hold them, and how they get there.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <rfsmooth/denoise.h>

#include "pipeline/cli/files/file_options.h"
#include "pipeline/io/io.h"

namespace rfsmooth::cli {

struct NormalsFields {
  bool normals = false;
  std::optional<std::string> viewpoint;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"normals", "write the smoothed surface's unit normals, all on one side", ""},
          self.normals);
    visit(OptionInfo{"viewpoint",
                     "x,y,z of the scanner, which the normals face; auto: the file's, else outward", ""},
          self.viewpoint);
  }
};

/// Options that cannot be meant, told before any file is touched. \throw Failure (usage).
void check(const NormalsFields& options);

/// Fields that could not take the normals, told before the work. \throw Failure (usage).
void check_normals(const NormalsFields& options, const pipeline::io::Cloud& cloud);

/// Estimates the normals of the coordinates `xyz` (the cloud's, smoothed, as doubles) and writes them: into
/// every complete triple nx, ny, nz or normal_x, normal_y, normal_z in its own type, else into new float32
/// fields named as `output`'s format does. Rows that are not finite keep what they have; new fields get NaN
/// there. Adds a stage and tells `entry` the viewpoint. \throw Failure.
void write_normals(const NormalsFields& options, pipeline::io::Cloud& cloud, const double* xyz,
                   const std::string& output, const FileOptions& files, const Context& context,
                   std::vector<StageTime>& stages, nlohmann::ordered_json& entry);

}  // namespace rfsmooth::cli
