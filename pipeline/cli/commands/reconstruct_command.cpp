#include "pipeline/cli/commands/reconstruct_command.h"

#include <map>
#include <memory>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/files/cloud_jobs.h"
#include "pipeline/cli/files/cloud_normals.h"
#include "pipeline/cli/files/memory.h"
#include "pipeline/cli/files/surface_file.h"
#include "pipeline/cli/other_program.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

/// The method, by its name, and how it is used.
struct SurfaceOptions : ReconstructOptions {
  std::string method = "poisson";
  std::optional<std::string> viewpoint;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    OptionInfo method{"method", "how the surface is made", ""};
    method.choices = {"poisson", "advancing-front", "ball-pivoting"};
    visit(method, self.method);
    visit(viewpoint_option(), self.viewpoint);
    ReconstructOptions::describe(self, visit);
  }
};

struct ReconstructCommandOptions {
  SurfaceOptions reconstruct;
  JobOptions job;
};

/// The options that do nothing beside the others, and what makes it so.
std::map<std::string, std::string> without_effect(const SurfaceOptions& options,
                                                  const SurfaceMethod& method) {
  std::map<std::string, std::string> idle;
  if (!method.closes_all) idle["trim"] = "--method " + method.name;
  if (options.denoise) return idle;
  DenoiseOptions unused;
  for (const CommandOption& option : collect(unused)) idle[option.name] = "--no-denoise";
  return idle;
}

/// Refuses options that were typed and do nothing, and a viewpoint that is none. \throw Failure (usage).
void check_options(const SurfaceOptions& options, const SurfaceMethod& method, const Invocation& typed) {
  typed_viewpoint(options.viewpoint);
  const auto idle = without_effect(options, method);
  for (const auto& [name, text] : typed.options)
    if (const auto it = idle.find(name); it != idle.end())
      fail(ErrorCode::usage, "--{} has no effect with {}", name, it->second);
}

/// Checked before the work: the output must be able to hold faces.
void check_format(const Job& job, const FileOptions& options, const pipeline::io::Cloud& cloud) {
  using pipeline::io::Format;
  const Format format = target_of(cloud, job.output, options, Format::ply).format;
  if (format != Format::ply && format != Format::off)
    fail(ErrorCode::usage, "{}: {} cannot hold a surface; use PLY or OFF", job.output,
         pipeline::io::name_of(format));
}

std::string text_of(const Topology& found) {
  std::string text = fmt::format("{}, {}, {}", counted(found.vertices, "vertex", "vertices"),
                                 counted(found.faces, "face"), counted(found.components, "piece"));
  if (found.closed_manifold()) return fmt::format("{}; closed, genus {}", text, found.genus);
  if (found.boundary_loops > 0)
    text +=
        fmt::format("; {} {}", found.boundary_loops, found.boundary_loops == 1 ? "rim" : "rims and holes");
  return text + (found.manifold() ? "" : "; not a manifold");
}

void enter(const Reconstruction& made, const ReconstructCommandOptions& options, const SurfaceMethod& method,
           ordered_json& entry) {
  ReconstructCommandOptions used = options;
  if (options.reconstruct.denoise) used.reconstruct.denoising = made.report.denoised.effective;
  entry["options"] = effective_options(used.reconstruct, options.job.files);
  for (const auto& [name, because] : without_effect(options.reconstruct, method))
    entry["options"].erase(name);
  const Topology& found = made.report.topology;
  entry["counts"] = {{"points", entry["input"]["points"]},
                     {"vertices", found.vertices},
                     {"faces", found.faces},
                     {"raw_faces", made.report.raw_faces},
                     {"filled_holes", made.report.filled},
                     {"components", found.components},
                     {"boundary_edges", found.boundary_edges},
                     {"boundary_loops", found.boundary_loops},
                     {"crowded_edges", found.crowded_edges},
                     {"disagreeing_edges", found.disagreeing_edges},
                     {"pinched_vertices", found.pinched_vertices}};
  entry["closed_manifold"] = found.closed_manifold();
  entry["genus"] = found.manifold() ? ordered_json(found.genus) : ordered_json(nullptr);
  entry["spacing"] = made.report.spacing;
  if (options.reconstruct.denoise) entry["noise"] = made.report.denoised.noise;
}

std::string reconstruct_cloud(const ReconstructCommandOptions& options, const SurfaceMethod& method,
                              pipeline::io::Cloud& cloud, const CloudTask& task) {
  const auto& [job, context, console, stages, entry] = task;
  check_format(job, options.job.files, cloud);
  need_memory(rfsmooth::denoise_memory(cloud.size()));
  const std::vector<double> xyz = pipeline::io::positions(cloud, context);
  ReconstructOptions how = options.reconstruct;
  how.normals = normals_facing(options.reconstruct.viewpoint, cloud, xyz.data(), task);
  const Reconstruction made = value_or_throw(rfsmooth::reconstruct(xyz, how, method, context));
  warn_if_coarse(cloud, xyz, made.report.spacing, job.input, console);
  cloud = surface_file(std::move(cloud), made, context);
  stages.insert(stages.end(), made.report.seconds.begin(), made.report.seconds.end());
  enter(made, options, method, entry);
  return text_of(made.report.topology);
}

/// A surface takes about as long as its normals, whatever the method; the bar stands still meanwhile.
std::vector<StageShare> reconstructing_stages(const ReconstructCommandOptions& options) {
  std::vector<StageShare> stages = options.reconstruct.denoise
                                       ? denoising_stages(true)
                                       : std::vector<StageShare>{{"read", 1}, {"normals", 100}};
  stages.push_back({options.reconstruct.method, 100});
  return stages;
}

const SurfaceMethod& find_method(const std::vector<SurfaceMethod>& methods, const std::string& name) {
  std::vector<std::string> names;
  for (const auto& method : methods) {
    if (method.name == name) return method;
    names.push_back(method.name);
  }
  fail(ErrorCode::not_installed,
       "--method {} is not in this rfsmooth-reconstruct, which was built without {}; it has {}", name,
       name == "advancing-front" ? "CGAL" : "Open3D", fmt::join(names, ", "));
}

Command table(const std::shared_ptr<ReconstructCommandOptions>& options) {
  Command command;
  command.name = "reconstruct";
  command.summary = "make a surface from a noisy cloud";
  command.usage = {"[options] IN OUT.ply"};
  command.description =
      "Takes the noise out of a cloud, as rfsmooth denoise does, gives the points normals on one side, and "
      "makes a triangle mesh of them: closed shapes face outward, scans the scanner, where the file tells "
      "or --viewpoint says where it stood. poisson (Open3D's screened Poisson) makes a smooth surface near "
      "the points and closes gaps; what it invents far from every point is trimmed. advancing-front (CGAL) "
      "and ball-pivoting (Open3D) put triangles between the points themselves: specks are dropped, slits "
      "filled, and where an advancing front all but bounds a solid, it is closed. All scales come from the "
      "measured spacing. Outliers are left out (--outliers smooth keeps them). Colours and other fields of "
      "the points go to the vertices.\n\n"
      "The work is done by the program rfsmooth-reconstruct, which links those libraries and may be "
      "installed or not; without it, or without the library that a method needs, the exit code is 127.";
  command.options = collect(options->reconstruct, options->job);
  command.everyday = {"method", "denoise", "trim",   "fill-holes", "strength", "output",
                      "force",  "threads", "report", "quiet",      "verbose"};
  return command;
}

}  // namespace

Command reconstruct_command() {
  const auto options = std::make_shared<ReconstructCommandOptions>();
  Command command = table(options);
  command.run = [options, known = command.options](const Invocation& typed) {
    return become_program("rfsmooth-reconstruct", as_typed(typed, known));
  };
  return command;
}

Command reconstruct_command(std::vector<SurfaceMethod> methods) {
  const auto options = std::make_shared<ReconstructCommandOptions>();
  Command command = table(options);
  command.run = [options, methods = std::move(methods)](const Invocation& typed) {
    const SurfaceMethod& method = find_method(methods, options->reconstruct.method);
    OnCloud on_cloud = {
        [&](const Invocation& given) { check_options(options->reconstruct, method, given); },
        [&] { return reconstructing_stages(*options); },
        [&](auto& cloud, const CloudTask& task) { return reconstruct_cloud(*options, method, cloud, task); },
        {},
        pipeline::io::Format::ply};
    on_cloud.will_lose = lost_in_surface;
    return run_cloud_jobs("reconstruct", options->job, typed, on_cloud);
  };
  return command;
}

}  // namespace rfsmooth::cli
