/// rfsmooth mesh: the connectivity that denoise works on, as a PLY to look at, stage by stage.
#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/files/cloud_jobs.h"
#include "pipeline/cli/files/memory.h"
#include "pipeline/io/convert/convert.h"
#include "pipeline/io/mesh_file.h"
#include "pipeline/outliers.h"
#include "pipeline/prepare.h"
#include "pipeline/row_order.h"
#include "rfs_mesh/connect/connect.h"
#include "rfs_mesh/corners.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

struct MeshOptions {
  std::string stage = "rfs";
  ConnectOptions connect;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    OptionInfo stage{"stage",
                     "what to write: the tree that is used, the surface description graph made from it "
                     "(edges: lines in MeshLab, Open3D and rfsmooth render; CloudCompare shows points only), "
                     "the RFS-mesh; or the tree of the points as they are, noise and all",
                     ""};
    stage.choices = {"emst", "sdg", "rfs", "emst-points"};
    visit(stage, self.stage);
    ConnectOptions::describe(self.connect, visit);
  }
};

struct MeshCommandOptions {
  MeshOptions mesh;
  JobOptions job;
};

/// What a stage needs: what only later ones need is not made.
rfs_mesh::Wanted wanted_for(const std::string& stage) {
  rfs_mesh::Wanted wanted;
  wanted.up_to = stage == "emst-points" ? ConnectUpTo::emst
                 : stage == "emst"      ? ConnectUpTo::tree
                 : stage == "sdg"       ? ConnectUpTo::sdg
                                        : ConnectUpTo::mesh;
  wanted.emst = wanted.tree = false;
  return wanted;
}

/// What the stages up to the one that was asked for made.
ordered_json counts_of(const Connection& connection, const std::string& stage) {
  if (stage == "emst") return {{"emst_edges", connection.tree.size()}};
  if (stage == "emst-points") return {{"emst_edges", connection.emst.size()}};
  ordered_json counts = {{"sdg_edges", connection.sdg.size()}, {"bridges", connection.bridges.size()}};
  if (stage == "rfs")
    counts.update({{"edges", connection.mesh.edge_count()},
                   {"faces", connection.mesh.faces.size()},
                   {"faceless", connection.faceless}});
  return counts;
}

/// Edges to write, and what each is: 0 of the tree, 1 added to it, 2 a bridge: of the tree, but no
/// neighbours.
struct Graph {
  std::vector<Edge> edges;
  std::vector<std::uint8_t> kind;  ///< empty where all are of one kind
};

Graph graph_of(const std::string& stage, const Connection& connection) {
  if (stage == "emst") return {connection.tree, {}};
  if (stage == "emst-points") return {connection.emst, {}};
  if (stage == "rfs") return {connection.mesh.loose_edges, {}};
  Graph graph;
  std::merge(connection.sdg.begin(), connection.sdg.end(), connection.bridges.begin(),
             connection.bridges.end(), std::back_inserter(graph.edges));
  for (const Edge& e : graph.edges) {
    const auto in = [&e](const std::vector<Edge>& all) {
      return std::binary_search(all.begin(), all.end(), e);
    };
    graph.kind.push_back(in(connection.bridges) ? 2 : in(connection.tree) ? 0 : 1);
  }
  return graph;
}

std::string connect_cloud(const MeshCommandOptions& options, pipeline::io::Cloud& cloud,
                          const CloudTask& task) {
  const auto& [job, context, console, stages, entry] = task;
  const std::string& stage = options.mesh.stage;
  const bool needs_noise = stage != "emst-points";
  need_memory(rfsmooth::denoise_memory(cloud.size()));
  const std::vector<double> xyz = pipeline::io::positions(cloud, context);
  rfs_mesh::WorkingCloud working =
      value_or_throw(rfs_mesh::make_working_cloud(xyz.data(), cloud.size(), context));
  Connection connection;
  Statistics whole;
  in_arena(context, [&] {
    const ConnectOptions& connect = options.mesh.connect;
    // All points are vertices, strays, too; the noise that tells their neighbourhoods is that of the others.
    pipeline::Prepared prepared =
        pipeline::prepare(working, connect.neighbours, Outliers::smooth, whole, task.stages, task.context);
    if (needs_noise) {
      const Stopwatch watch(task.stages, "noise");
      pipeline::find_noise(*prepared.index, prepared.near, whole, task.context);
    }
    connection = value_or_throw(rfs_mesh::connect(std::move(*prepared.index), std::move(prepared.near),
                                                  connect, wanted_for(stage), task.context, &whole));
  });
  add_times(connection.seconds, stages);
  warn_if_coarse(cloud, xyz, connection.noise.spacing, job.input, console);

  const pipeline::RowOrder order = pipeline::row_order(working);
  Positions points;  // at the file's own coordinates
  for (const std::size_t i : order.row) points.emplace_back(&xyz[3 * i]);
  Graph graph = graph_of(stage, connection);
  for (Edge& e : graph.edges) e = rfs_mesh::edge_between(order.rank[e[0]], order.rank[e[1]]);
  std::vector<Face> faces;
  if (stage == "rfs") faces = connection.mesh.faces;
  for (auto& face : faces)
    for (Index& corner : face) corner = order.rank[corner];
  const pipeline::io::Encoding encoding = cloud.encoding;
  cloud = pipeline::io::make_mesh_file(points, faces, graph.edges, graph.kind);
  if (encoding != pipeline::io::Encoding::binary_compressed) cloud.encoding = encoding;  // PLY has none

  entry["options"] = effective_options(options.mesh, options.job.files);
  entry["counts"] = {{"points", xyz.size() / 3}, {"vertices", points.size()}};
  entry["counts"].update(counts_of(connection, stage));
  entry["spacing"] = connection.noise.spacing;
  if (needs_noise) entry["noise"] = connection.noise.sigma;
  return fmt::format("{}: {}, {}, {}", stage, counted(points.size(), "vertex", "vertices"),
                     counted(graph.edges.size(), "edge"), counted(faces.size(), "face"));
}

/// What is reported until the stage that was asked for is made.
std::vector<StageShare> stages_up_to(const std::string& stage) {
  std::vector<StageShare> stages = connecting_stages();
  const std::string ends = stage == "emst" ? "shadow" : stage == "emst-points" ? "emst" : stage;
  const auto last =
      std::find_if(stages.begin(), stages.end(), [&](const StageShare& s) { return s.stage == ends; });
  if (last != stages.end()) stages.erase(last + 1, stages.end());
  return stages;
}

}  // namespace

Command mesh_command() {
  auto options = std::make_shared<MeshCommandOptions>();
  Command command;
  command.name = "mesh";
  command.summary = "write the mesh that denoise makes of the points, or the graphs it is made from";
  command.usage = {"[options] IN OUT", "[options] IN... -o FOLDER"};
  command.description =
      "Connects the points of a cloud and writes a PLY: edges for the Euclidean minimum spanning tree (emst) "
      "and the surface description graph (sdg), faces for the RFS-mesh (rfs; edges of points without a face "
      "are kept as edges). The graph has all edges of the tree; its property kind is 0 for those, 1 for the "
      "added ones, and 2 for edges of the tree that are no neighbourhood (bridges). In noise both stand on "
      "the points' shadows on the surface. Only the stages up to that one are run. Points that are not "
      "finite are left out, coincident ones become one vertex, as do twins where a tenth of the points have "
      "one; outliers, which denoise leaves out, stay in.\n\n"
      "Edges are lines in MeshLab, in Open3D (read_line_set) and for rfsmooth render; CloudCompare reads no "
      "edges from any PLY and shows the points only. Faces open everywhere.";
  command.options = collect(options->mesh, options->job);
  command.everyday = {"stage", "output", "force", "threads", "report", "quiet", "verbose"};
  command.on_cloud = {
      [](const Invocation&) {},
      [options] { return stages_up_to(options->mesh.stage); },
      [options](auto& cloud, const CloudTask& task) { return connect_cloud(*options, cloud, task); },
      {},
      pipeline::io::Format::ply};
  command.on_cloud.will_lose = [options](const auto&, Format format, Encoding, const Context&) {
    return options->mesh.stage == "rfs" ? pipeline::io::lost_of_triangles(format)
                                        : pipeline::io::lost_of_edges(format);
  };
  command.run = [options, on_cloud = command.on_cloud](const Invocation& typed) {
    return run_cloud_jobs("mesh", options->job, typed, on_cloud);
  };
  return command;
}

}  // namespace rfsmooth::cli
