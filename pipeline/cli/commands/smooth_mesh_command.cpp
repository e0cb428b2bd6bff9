/// rfsmooth smooth-mesh: any flow on a mesh from a file; then, if asked for, a finer mesh through its
/// vertices, and its ridges and ravines as a field.
#include <cmath>
#include <memory>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <rfsmooth/denoise.h>

#include "base/disjoint_sets.h"
#include "base/fail.h"
#include "base/stopwatch.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/console/solver_said.h"
#include "pipeline/cli/console/trace_file.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/cli/files/cloud_jobs.h"
#include "pipeline/cli/files/constraint_fields.h"
#include "pipeline/cli/files/file_mesh.h"
#include "pipeline/cli/files/memory.h"
#include "pipeline/io/convert/convert.h"
#include "pipeline/io/point_fields.h"
#include "rfs_mesh/edge_faces.h"
#include "rfs_mesh/measure.h"
#include "smoothing/operators/surface.h"
#include "smoothing/remesh/refine.h"
#include "smoothing/remesh/ridges.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

/// What may follow the flow.
struct After {
  smoothing::RefineOptions refine{0, Chart::mixed, 0, 1e-4};
  std::optional<double> sharp_angle;
  bool ridges = false;
  double ridge_curvature = 0.1;  // a turn of six degrees from edge to edge

  /// \throw Failure for an option that was typed without the one it belongs to.
  void check_partners(const Invocation& typed) const {
    for (const auto& [name, text] : typed.options) {
      if (refine.levels == 0 && (name == "refine-chart" || name == "refine-pimple" || name == "sharp-angle"))
        fail(ErrorCode::usage, "--{} has no effect without --refine", name);
      if (!ridges && name == "ridge-curvature")
        fail(ErrorCode::usage, "--ridge-curvature has no effect without --ridges");
    }
  }

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"refine", "levels of refinement after the flow; each multiplies the faces by four", "",
                     0, 10},
          self.refine.levels);
    visit(words("refine-chart", "refinement: how neighbours get their parameters", Shared::kCharts),
          self.refine.chart);
    visit(OptionInfo{"refine-pimple", "refinement: how far given vertices may move at the end", "x mean edge",
                     0, 10},
          self.refine.pimple);
    visit(OptionInfo{"sharp-angle",
                     "refinement: edges where the normals turn by more stay sharp curves; auto: none",
                     "degrees", 0, 180},
          self.sharp_angle);
    visit(OptionInfo{"ridges", "write the field ridge: 1 on ridges, -1 on ravines, else 0", ""}, self.ridges);
    visit(OptionInfo{"ridge-curvature", "least curvature of a ridge or ravine", "1 / mean edge", 0, 1e6},
          self.ridge_curvature);
  }
};

struct SmoothMeshCommandOptions {
  FlowOptions flow;
  ConstraintFields constraints;
  After after;
  TraceFile trace;
  JobOptions job;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    FlowOptions::describe(self.flow, visit);
    ConstraintFields::describe(self.constraints, visit);
    After::describe(self.after, visit);
    TraceFile::describe(self.trace, visit);
  }
};

/// The edges between two faces whose normals turn by more than `degrees`.
std::vector<Edge> sharp_edges(const Mesh& mesh, double degrees) {
  using rfs_mesh::EdgeFace;
  const double least = std::cos(degrees * M_PI / 180);
  const auto normal = [&](const EdgeFace& at) {
    return rfs_mesh::face_cross(mesh.positions, mesh.faces[at.face]).normalized();
  };
  std::vector<Edge> sharp;
  rfs_mesh::for_each_edge(rfs_mesh::edge_faces(mesh.faces), [&](const EdgeFace* first, const EdgeFace* last) {
    if (last - first != 2) return;
    const Eigen::Vector3d one = normal(first[0]), two = normal(first[1]);
    if (one.isZero(0) || two.isZero(0)) return;  // a face without area has no normal
    const double cosine = one.dot(two);          // faces that run the same way disagree
    if ((first[0].forward == first[1].forward ? -cosine : cosine) < least)
      sharp.push_back({first->a, first->b});
  });
  return sharp;
}

/// Turns faces that do not agree with their neighbours, so that ridges and ravines are told apart. A part
/// whose faces agree keeps the side that the file chose: a cavity is inside out on purpose.
void make_agree(Mesh& mesh) {
  using rfs_mesh::EdgeFace;
  DisjointSets<Index> parts(mesh.faces.size());
  std::vector<Index> at_odds;
  rfs_mesh::for_each_edge(rfs_mesh::edge_faces(mesh.faces), [&](const EdgeFace* first, const EdgeFace* last) {
    if (last - first != 2) return;
    parts.join(first[0].face, first[1].face);
    if (first[0].forward == first[1].forward) at_odds.push_back(first->face);
  });
  if (at_odds.empty()) return;
  std::vector<char> turns(mesh.faces.size(), 0);
  for (const Index face : at_odds) turns[parts.of(face)] = 1;
  const std::vector<Face> agreeing = smoothing::oriented_as_far_as_possible(mesh);
  for (std::size_t f = 0; f < agreeing.size(); ++f)
    if (turns[parts.of(Index(f))] != 0) mesh.faces[f] = agreeing[f];
}

/// Writes the refined mesh into the cloud.
void refine_file(const After& after, pipeline::io::Cloud& cloud, FileMesh& file,
                 const std::vector<double>& rows, const CloudTask& task) {
  const auto sharp = after.sharp_angle ? sharp_edges(file.mesh, *after.sharp_angle) : std::vector<Edge>{};
  Mesh fine = value_or_throw(smoothing::refine(file.mesh, after.refine, task.context, sharp));
  const std::vector<std::string> lost = lost_in_refined(cloud);
  const auto& fields = cloud.points().fields;
  pipeline::io::warn_of_rounding({fields[cloud.xyz[0]], fields[cloud.xyz[1]], fields[cloud.xyz[2]]}, 0,
                                 task.context);
  put_refined(cloud, file, rows, fine);
  file.mesh = std::move(fine);
  if (!lost.empty())
    task.console.warn(
        fmt::format("{}: a refined mesh has new points; only x, y, z and triangles are written, not {}",
                    task.job.input, fmt::join(lost, ", ")));
}

/// Adds the field of ridges and ravines.
void mark_ridges(const After& after, pipeline::io::Cloud& cloud, FileMesh& file, const Context& context) {
  make_agree(file.mesh);
  const std::vector<int> kind = smoothing::ridges_and_ravines(file.mesh, after.ridge_curvature, context);
  std::vector<double> field(cloud.size(), 0);
  for (std::size_t i = 0; i < field.size(); ++i) {
    // Rows behind the given ones are the refined vertices, in their order.
    const std::size_t given = file.of_row.size();
    const std::size_t v = i < given ? file.of_row[i] : file.before.size() + i - given;
    if (v != kNone) field[i] = kind[v];
  }
  pipeline::io::set_field(cloud, "ridge", pipeline::io::Scalar::int8, field, context);
}

std::string smooth_file(const SmoothMeshCommandOptions& options, std::vector<TraceRow>& trace,
                        pipeline::io::Cloud& cloud, const CloudTask& task) {
  const auto& [job, context, console, stages, entry] = task;
  if (options.after.ridges && !options.job.files.drop_unsupported &&
      output_format(cloud, job.output, options.job.files) == pipeline::io::Format::off)
    fail(ErrorCode::usage, "{}: OFF cannot hold the field of --ridges; use PLY", job.output);
  Stopwatch watch(stages, "connect");
  FileMesh file =
      file_mesh(cloud, job.input, context, options.flow.modifiers.preserve == Preserve::height_field);
  // The last mesh of a refinement takes, for each of its vertices, what a point of a cloud takes.
  if (const int levels = options.after.refine.levels; levels > 0)
    need_memory(rfsmooth::denoise_memory(smoothing::refined_vertices(file.mesh, levels)));
  const auto constraints =
      constraints_of(options.constraints, cloud, file.of_row, file.before.size(), task.context);
  watch.next("smooth");
  FlowOptions flow = options.flow;
  flow.trace = options.trace.trace.has_value();
  auto done = value_or_throw(rfsmooth::smooth(file.mesh, flow, context, constraints));
  trace = std::move(done.trace);
  tell_solver(job.input, done.solver, console);
  bool moved = false;
  const std::vector<double> rows = file.moved_rows(moved);
  const std::size_t points = cloud.size(), faces = file.mesh.faces.size();
  if (options.after.refine.levels > 0) {
    watch.next("refine");
    refine_file(options.after, cloud, file, rows, task);
  } else {
    pipeline::io::set_positions(cloud, rows.data(), context);
    if (moved && pipeline::io::has_normals(cloud))
      console.warn(fmt::format("{}: the normals are stale: they describe the old positions", job.input));
  }
  if (options.after.ridges) {
    watch.next("ridges");
    mark_ridges(options.after, cloud, file, context);
  }

  SmoothMeshCommandOptions used = options;
  used.trace.trace.reset();  // what is written beside the mesh is not how it was made
  entry["options"] = effective_options(used, options.job.files);
  entry["counts"] = {{"points", points},
                     {"finite", file.before.size()},
                     {"faces", faces},
                     {"constrained", constraints.hard.size()},
                     {"written_points", cloud.size()},
                     {"written_faces", file.mesh.faces.size()},
                     {"steps", done.steps},
                     {"solver_iterations", done.solver.iterations}};
  entry["solver"] = json_of(done.solver);
  entry["largest_move"] = done.largest_move;
  return fmt::format("{}, {}; {}; largest move {:.4g}", counted(points, "vertex", "vertices"),
                     counted(faces, "face"), counted(std::uint64_t(done.steps), "step"), done.largest_move);
}

void check_smooth_mesh(const SmoothMeshCommandOptions& options, const Invocation& typed) {
  options.after.check_partners(typed);
  if (const auto& fields = options.constraints; fields.direction && !fields.axis && !fields.plane)
    fail(ErrorCode::usage, "--slide-direction has no effect without --axis-field or --plane-field");
}

}  // namespace

Command smooth_mesh_command() {
  auto options = std::make_shared<SmoothMeshCommandOptions>();
  Command command;
  command.name = "smooth-mesh";
  command.summary = "smooth a triangle mesh from a file with any flow; refine it; find its ridges";
  command.usage = {"[options] IN OUT", "[options] IN... -o FOLDER"};
  command.description =
      "Reads a mesh (PLY with faces, OFF), moves its vertices by a flow and writes the same file with x, y, "
      "z replaced. Faces, fields and order stay; polygons count as fans of triangles. Vertices that are not "
      "finite stay as they are.\n\n"
      "Fields of the file can hold vertices back (--strength-field), fix them (--fixed-field) or let them "
      "slide (--axis-field, --plane-field). --refine puts a finer, fair mesh through the vertices "
      "(--iterations 0 refines without smoothing); --ridges marks ridges and ravines.";
  command.options = collect(*options, options->job);
  command.everyday = {"flow",  "iterations", "strength-field", "refine", "ridges", "output",
                      "force", "threads",    "report",         "quiet",  "verbose"};
  const auto trace = std::make_shared<std::vector<TraceRow>>();
  command.on_cloud = {[options](const Invocation& typed) { check_smooth_mesh(*options, typed); },
                      [options]() -> std::vector<StageShare> {
                        const double refining = options->after.refine.levels > 0 ? 20 : 0;
                        return {{"read", 1}, {"smooth", 10}, {"refine", refining}};
                      },
                      [options, trace](auto& cloud, const CloudTask& task) {
                        return smooth_file(*options, *trace, cloud, task);
                      },
                      [options, trace](Console&) { options->trace.write(*trace, options->job.files); }};
  command.on_cloud.files_beside = [options] { return options->trace.files(); };
  command.on_cloud.will_lose = [options](const auto& cloud, Format format, Encoding encoding,
                                         const Context& context) {
    return options->after.refine.levels > 0  // then there are only x, y, z and faces
               ? pipeline::io::lost_of_triangles(format)
               : pipeline::io::what_will_be_lost(cloud, {}, format, encoding, context);
  };
  command.run = [options, on_cloud = command.on_cloud](const Invocation& typed) {
    return run_cloud_jobs("smooth-mesh", options->job, typed, on_cloud);
  };
  return command;
}

}  // namespace rfsmooth::cli
