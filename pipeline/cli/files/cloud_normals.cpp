#include "pipeline/cli/files/cloud_normals.h"

#include <algorithm>
#include <cmath>

#include "base/fail.h"
#include "base/stopwatch.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/cli/options/text_values.h"
#include "pipeline/io/point_fields.h"
#include "pipeline/tiles/files/row_file.h"
#include "pipeline/viewpoint.h"

namespace rfsmooth::cli {

namespace io = pipeline::io;
using Eigen::Vector3d;
using Names = io::NormalNames;

namespace {

/// Writes n x 3 normals into the fields; rows of NaN keep what is there.
void put(io::Cloud& cloud, const Names& names, const std::vector<double>& normals, const Context& context) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto present = io::find_field(cloud, names[axis]);
    std::vector<double> values = present ? io::field_values(cloud, *present, context)
                                         : std::vector<double>(cloud.size(), std::nan(""));
    for (std::size_t i = 0; i < values.size(); ++i)
      if (const double value = normals[3 * i + axis]; !std::isnan(value)) values[i] = value;
    io::set_field(cloud, names[axis], io::Scalar::float32, values, context);
  }
}

}  // namespace

std::optional<Vector3d> typed_viewpoint(const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  auto point = read_point(*text);
  if (!point) fail(ErrorCode::usage, "--viewpoint: expected x,y,z; found '{}'", *text);
  return point;
}

NormalsOptions normals_facing(const std::optional<std::string>& viewpoint, const io::Cloud& cloud,
                              const double* xyz, const CloudTask& task) {
  NormalsOptions wanted;
  wanted.viewpoint = typed_viewpoint(viewpoint);
  if (!wanted.viewpoint) wanted.viewpoint = pipeline::recorded_viewpoint(cloud, xyz, task.context);
  auto& told = task.entry["normals"]["viewpoint"];
  told = nullptr;
  if (const auto& v = wanted.viewpoint) told = {(*v)[0], (*v)[1], (*v)[2]};
  return wanted;
}

void check(const NormalsFields& options) {
  if (typed_viewpoint(options.viewpoint) && !options.normals)
    fail(ErrorCode::usage, "--viewpoint says where normals point; it needs --normals");
}

std::optional<NormalsOptions> normals_in_tiles(const NormalsFields& options,
                                               const std::vector<std::string>& inputs,
                                               const Context& context) {
  if (!options.normals) return std::nullopt;
  NormalsOptions wanted;
  wanted.viewpoint = typed_viewpoint(options.viewpoint);
  if (!wanted.viewpoint) wanted.viewpoint = pipeline::tiles::common_viewpoint(inputs, context);
  return wanted;
}

void check_normals(const NormalsFields& options, const io::Cloud& cloud) {
  if (!options.normals) return;
  for (const Names& names : {io::kPlyNormal, io::kPcdNormal})
    for (const char* name : names) io::check_field(cloud, name, io::Scalar::float32);
}

void write_normals(const NormalsFields& options, io::Cloud& cloud, const double* xyz,
                   const FileOptions& files, const CloudTask& task) {
  if (!options.normals) return;
  const auto& [job, context, console, stages, entry] = task;
  const Stopwatch watch(stages, "normals");
  const NormalsOptions wanted = normals_facing(options.viewpoint, cloud, xyz, task);
  std::vector<double> normals(3 * cloud.size());
  value_or_throw(rfsmooth::estimate_normals(xyz, cloud.size(), wanted, context, normals.data()));
  const auto there = [&](const char* name) { return io::find_field(cloud, name).has_value(); };
  bool written = false;
  for (const Names& names : {io::kPlyNormal, io::kPcdNormal}) {
    if (!std::all_of(names.begin(), names.end(), there)) continue;
    put(cloud, names, normals, context);
    written = true;
  }
  if (!written)
    put(cloud, output_format(cloud, job.output, files) == io::Format::pcd ? io::kPcdNormal : io::kPlyNormal,
        normals, context);
}

}  // namespace rfsmooth::cli
