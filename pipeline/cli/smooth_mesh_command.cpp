/// rfsmooth smooth-mesh: any flow on a mesh from a file; the connectivity stays.
#include <chrono>
#include <memory>

#include <fmt/format.h>

#include "rfsmooth/pipeline/cli/cloud_jobs.h"
#include "rfsmooth/pipeline/cli/command.h"
#include "rfsmooth/pipeline/io/mesh_file.h"
#include "rfsmooth/smoothing/flow.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

struct Options {
  smoothing::FlowOptions flow;
  JobOptions job;
};

/// The mesh over the finite vertices, around a local origin.
struct FileMesh {
  rfs_mesh::Mesh mesh;
  std::vector<Index> of_row;  ///< kNone for vertices that are not finite
};

FileMesh mesh_of(const pipeline::io::Cloud& cloud, const std::vector<double>& xyz, const std::string& name,
                 const Context& context) {
  const std::vector<rfs_mesh::Face> faces = pipeline::io::faces_of(cloud, context);
  if (faces.empty())
    throw Failure({ErrorCode::input_unreadable,
                   name + ": has no faces; expected a mesh (for clouds use: rfsmooth denoise)"});
  FileMesh out;
  out.of_row.assign(cloud.size(), kNone);
  Positions& points = out.mesh.positions;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
    if (!p.allFinite()) continue;
    out.of_row[i] = Index(points.size());
    points.push_back(p);
  }
  if (points.empty()) throw Failure({ErrorCode::no_usable_points, name + ": no vertex is finite"});
  const Eigen::Vector3d origin = points.front();
  for (auto& p : points) p -= origin;
  for (const rfs_mesh::Face& face : faces) {
    const rfs_mesh::Face f = {out.of_row[face[0]], out.of_row[face[1]], out.of_row[face[2]]};
    const bool whole = f[0] != kNone && f[1] != kNone && f[2] != kNone;
    if (whole && f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) out.mesh.faces.push_back(f);
  }
  rfs_mesh::rebuild_adjacency(out.mesh, context);
  return out;
}

std::string smooth_file(const Options& options, pipeline::io::Cloud& cloud, const Job& job,
                        const Context& context, Console& console, std::vector<pipeline::StageTime>& stages,
                        ordered_json& entry) {
  std::vector<double> xyz = pipeline::io::positions(cloud, context);
  FileMesh file = mesh_of(cloud, xyz, job.input, context);
  const Positions before = file.mesh.positions;
  const auto start = std::chrono::steady_clock::now();
  const auto result = smoothing::smooth(file.mesh, options.flow, context);
  if (!result.ok()) throw Failure({result.error().code, job.input + ": " + result.error().message});
  stages.push_back(
      {"smooth", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
  bool moved = false;
  for (std::size_t i = 0; i < file.of_row.size(); ++i) {
    if (file.of_row[i] == kNone) continue;
    const Eigen::Vector3d move = file.mesh.positions[file.of_row[i]] - before[file.of_row[i]];
    for (int axis = 0; axis < 3; ++axis)
      if (move[axis] != 0) {
        xyz[3 * i + std::size_t(axis)] += move[axis];
        moved = true;
      }
  }
  pipeline::io::set_positions(cloud, xyz.data(), context);
  if (moved && has_normals(cloud))
    console.warn(fmt::format("{}: the normals are kept; they now describe the old positions", job.input));

  entry["options"] = effective_options(smoothing::complete(options.flow).value(), options.job.files);
  entry["counts"] = {{"points", cloud.size()},
                     {"finite", before.size()},
                     {"faces", file.mesh.faces.size()},
                     {"steps", result.value().steps},
                     {"solver_iterations", result.value().solver_iterations}};
  entry["largest_move"] = result.value().largest_move;
  return fmt::format("{} vertices, {} faces; {} steps; largest move {:.4g}", cloud.size(),
                     file.mesh.faces.size(), result.value().steps, result.value().largest_move);
}

int run(const Options& options, const Invocation& typed) {
  if (const auto valid = smoothing::complete(options.flow); !valid.ok()) throw Failure(valid.error());
  return run_cloud_jobs("smooth-mesh", options.job, typed, [&](auto&&... all) {
    return smooth_file(options, std::forward<decltype(all)>(all)...);
  });
}

}  // namespace

Command smooth_mesh_command() {
  auto options = std::make_shared<Options>();
  Command command;
  command.name = "smooth-mesh";
  command.summary = "smooth a triangle mesh from a file with any flow";
  command.usage = {"[options] IN OUT", "[options] IN... -o FOLDER/"};
  command.description =
      "Reads a mesh (PLY with faces, OFF), moves its vertices by a flow and writes the same file with x, y, "
      "z "
      "replaced. Faces, fields and order stay; polygons count as fans of triangles. Vertices that are not "
      "finite "
      "stay as they are.";
  collect(options->flow, command.options);
  collect(options->job, command.options);
  polish(command);
  command.run = [options](const Invocation& typed) { return run(*options, typed); };
  return command;
}

}  // namespace rfsmooth::cli
