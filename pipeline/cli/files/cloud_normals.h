/// Normals of the smoothed surface in the sub-commands: their options, and the fields that hold them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/denoise.h>
#include <rfsmooth/normals.h>

#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/files/file_options.h"
#include "pipeline/io/io.h"

namespace rfsmooth::cli {

/// Of every sub-command that finds normals.
inline OptionInfo viewpoint_option() {
  return {"viewpoint", "x,y,z of the scanner, which the normals face; auto: the file's, else outward", ""};
}

struct NormalsFields {
  bool normals = false;
  std::optional<std::string> viewpoint;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"normals", "write the smoothed surface's unit normals, all on one side", ""},
          self.normals);
    visit(viewpoint_option(), self.viewpoint);
  }
};

/// The viewpoint that was typed, if any. \throw Failure (usage).
std::optional<Eigen::Vector3d> typed_viewpoint(const std::optional<std::string>& text);

/// How the normals of a cloud with the coordinates `xyz` are found: with the viewpoint that was typed, else
/// the one that its file tells, else none. Told in the report. \throw Failure (usage).
NormalsOptions normals_facing(const std::optional<std::string>& viewpoint, const pipeline::io::Cloud& cloud,
                              const double* xyz, const CloudTask& task);

/// Refuses contradictory options, before any file is touched. \throw Failure (usage).
void check(const NormalsFields& options);

/// How tiles of the inputs find normals, if they were asked for: with the viewpoint that was typed, else the
/// one that all inputs tell, else none. \throw Failure.
std::optional<NormalsOptions> normals_in_tiles(const NormalsFields& options,
                                               const std::vector<std::string>& inputs,
                                               const Context& context);

/// Refuses fields that cannot take the normals, before the work. \throw Failure (usage).
void check_normals(const NormalsFields& options, const pipeline::io::Cloud& cloud);

/// Estimates the normals at the coordinates `xyz` (those of the cloud, smoothed) and writes them into every
/// complete triple nx, ny, nz or normal_x, normal_y, normal_z, in its own type. Without such a triple, new
/// float32 fields are added, named as the output's format does. Rows that are not finite keep their values;
/// in new fields they get NaN. Adds a stage, and the viewpoint to the report. \throw Failure.
void write_normals(const NormalsFields& options, pipeline::io::Cloud& cloud, const double* xyz,
                   const FileOptions& files, const CloudTask& task);

}  // namespace rfsmooth::cli
