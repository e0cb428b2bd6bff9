#include "pipeline/cli/files/cloud_normals.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include <rfsmooth/normals.h>

#include "base/stopwatch.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/cli/options/text_values.h"
#include "pipeline/viewpoint.h"

namespace rfsmooth::cli {

namespace io = pipeline::io;
using Eigen::Vector3d;
using Names = std::array<const char*, 3>;

namespace {

constexpr Names kPly = {"nx", "ny", "nz"}, kPcd = {"normal_x", "normal_y", "normal_z"};

/// "x,y,z" strictly. \throw Failure (usage).
Vector3d parse_point(const std::string& text) {
  const auto point = read_point(text);
  if (!point) throw Failure({ErrorCode::usage, fmt::format("--viewpoint: expected x,y,z; found '{}'", text)});
  return *point;
}

bool complete(const io::Cloud& cloud, const Names& names) {
  for (const char* name : names)
    if (!io::find_field(cloud, name)) return false;
  return true;
}

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

void check(const NormalsFields& options) {
  if (!options.viewpoint) return;
  parse_point(*options.viewpoint);
  if (!options.normals)
    throw Failure({ErrorCode::usage, "--viewpoint says where normals point; it needs --normals"});
}

void check_normals(const NormalsFields& options, const io::Cloud& cloud) {
  if (!options.normals) return;
  for (const Names& names : {kPly, kPcd})
    for (const char* name : names) io::check_field(cloud, name, io::Scalar::float32);
}

void write_normals(const NormalsFields& options, io::Cloud& cloud, const double* xyz,
                   const std::string& output, const FileOptions& files, const Context& context,
                   std::vector<StageTime>& stages, nlohmann::ordered_json& entry) {
  if (!options.normals) return;
  const Stopwatch watch(stages, "normals");
  NormalsOptions wanted;
  wanted.viewpoint =
      options.viewpoint ? parse_point(*options.viewpoint) : pipeline::recorded_viewpoint(cloud, xyz, context);
  std::vector<double> normals(3 * cloud.size());
  value_or_throw(rfsmooth::estimate_normals(xyz, cloud.size(), wanted, context, normals.data()));
  bool written = false;
  for (const Names& names : {kPly, kPcd}) {
    if (!complete(cloud, names)) continue;
    put(cloud, names, normals, context);
    written = true;
  }
  if (!written)
    put(cloud, output_format(cloud, output, files) == io::Format::pcd ? kPcd : kPly, normals, context);
  auto& viewpoint = entry["normals"]["viewpoint"];
  viewpoint = nullptr;
  if (const auto& v = wanted.viewpoint) viewpoint = {(*v)[0], (*v)[1], (*v)[2]};
}

}  // namespace rfsmooth::cli
