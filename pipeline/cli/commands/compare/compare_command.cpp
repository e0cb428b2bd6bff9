/// rfsmooth compare: a cloud against the truth, a mesh or a clean cloud.
#include <memory>

#include <fmt/format.h>

#include <rfsmooth/compare.h>

#include "base/fail.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/commands/compare/compare_figures.h"
#include "pipeline/cli/console/console.h"
#include "pipeline/cli/deviation.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/io/io.h"
#include "pipeline/io/json_file.h"
#include "pipeline/io/mesh_file.h"
#include "pipeline/io/point_fields.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

struct CompareCommandOptions {
  bool signed_normals = false;
  bool json = false;
  FileOptions files;  // only where the coloured cloud goes
  std::optional<double> red_from;
  ConsoleOptions console;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"signed-normals", "the normals of both claim a side: angles up to 180 degrees", ""},
          self.signed_normals);
    visit(OptionInfo{"json", "print JSON", ""}, self.json);
    visit(OptionInfo{"output",
                     "write the cloud here, coloured by its distance from the truth, blue to red, and with a "
                     "field 'deviation'",
                     "file"},
          self.files.output);
    visit(OptionInfo{"red-from", "distance from which points are red; auto: 95 % are nearer",
                     "units of the file", 0, 1e300},
          self.red_from);
    visit(OptionInfo{"force", "replace an existing file", ""}, self.files.force);
    ConsoleOptions::describe(self.console, visit);
  }
};

struct ToText {
  const ordered_json& on_unit_sphere;
  void operator()(const MeasureInfo& info, const std::optional<double>& value) {
    if (!value) return;
    std::string scaled;
    if (const auto it = on_unit_sphere.find(std::string(info.name));
        info.length_power > 0 && it != on_unit_sphere.end())
      scaled = fmt::format("{:.5g}", it->get<double>() * 1e4);
    fmt::print("{:<21} {:>12.6g} {:>12}  {}\n", info.name, *value, scaled, info.help);
  }
};

/// The file of the truth: a mesh, or a clean cloud if it has no faces. Keeps what `view` points at.
struct TruthFile {
  TruthFile(const std::string& path, const Context& context) {
    const auto file = load_cloud(path, context);
    xyz = pipeline::io::positions(file, context);
    faces = pipeline::io::value_or_fail(guarded([&] { return pipeline::io::faces_of(file, context); }), path);
    if (faces.empty()) {
      normals = pipeline::io::normals_of(file, context);
      view.cloud = CloudView{xyz.data(), file.size(), normals.empty() ? nullptr : normals.data()};
    } else {
      view.mesh = MeshView{xyz.data(), file.size(), faces.data(), faces.size()};
    }
  }
  bool has_normals() const { return view.mesh || !normals.empty(); }

  std::vector<double> xyz, normals;  // normals: of a clean cloud that has some
  std::vector<Face> faces;
  Truth view;
};

void print_text(const CompareReport& report, const Deviation& deviation, const ordered_json& json) {
  const bool mesh = report.truth_faces > 0;
  fmt::print("{} ({} finite) against {}\n", counted(report.points, "point"), report.finite,
             mesh ? counted(report.truth_faces, "true face") : counted(report.truth_points, "clean point"));
  fmt::print("distance of a point to {}, in the units of the file:\n",
             mesh ? "the surface" : "the nearest clean point");
  for (const auto& [name, value] : {std::pair("rms", deviation.rms),
                                    {"median", deviation.median},
                                    {"95 %", deviation.most},
                                    {"largest", deviation.largest}})
    fmt::print("  {:<8} {:.6g}\n", name, value);
  fmt::print("{:<21} {:>12} {:>12}  {}\n", "", "own units", "x 1e4", "(x 1e4: on the truth's unit sphere)");
  Measures::describe(report.own_units, ToText{json["unit_sphere"]});
}

int run_compare(const CompareCommandOptions& options, const Invocation& typed) {
  if (typed.arguments.size() != 2)
    fail(ErrorCode::usage, "two files are needed: the cloud and the truth (a mesh or a clean cloud)");
  need_one_standard_input(typed.arguments);
  if (options.red_from && !options.files.output)
    fail(ErrorCode::usage, "--red-from has no effect without -o");
  if (options.files.output == "-")
    fail(ErrorCode::usage, "-o needs the name of a file: standard output takes the figures");
  if (options.files.output) check_target(*options.files.output, options.files);
  Console console(options.console);
  const Context context = console.context({{"read", 1}, {"compare", 10}});
  auto cloud = load_cloud(typed.arguments[0], context);
  const TruthFile truth(typed.arguments[1], context);
  const std::vector<double> xyz = pipeline::io::positions(cloud, context),
                            normals = pipeline::io::normals_of(cloud, context);
  if (options.signed_normals && (normals.empty() || !truth.has_normals()))
    fail(ErrorCode::usage, "{}: has no normals, which --signed-normals compares",
         typed.arguments[normals.empty() ? 0 : 1]);
  CompareOptions compare_options;
  compare_options.signed_normals = options.signed_normals;
  const CompareReport report = pipeline::io::value_or_fail(
      rfsmooth::compare({xyz.data(), cloud.size(), normals.empty() ? nullptr : normals.data()}, truth.view,
                        compare_options, context),
      fmt::format("{} against {}", typed.arguments[0], typed.arguments[1]));
  const Deviation deviation = summed_up(report.deviation);
  ordered_json json = {{"cloud", typed.arguments[0]}, {"truth", typed.arguments[1]}};
  json.update(figures_of(report, deviation));
  if (options.json)
    fmt::print("{}", pipeline::io::in_lines(json));
  else
    print_text(report, deviation, json);
  if (!options.files.output) return 0;
  const double red = options.red_from.value_or(deviation.most);
  color_by_deviation(cloud, report.deviation, red, *options.files.output, context);
  store_cloud(cloud, *options.files.output, options.files, context);
  console.say(
      fmt::format("{}: blue 0, green {:.3g}, red from {:.3g} on", *options.files.output, red / 2, red));
  return 0;
}

}  // namespace

Command compare_command() {
  auto options = std::make_shared<CompareCommandOptions>();
  Command command;
  command.name = "compare";
  command.summary = "measure a cloud against the truth, a mesh or a clean cloud";
  command.usage = {"[options] CLOUD TRUTH"};
  command.description =
      "TRUTH is a mesh (PLY with faces, OFF) or a clean cloud. Prints the root of the mean square, the "
      "median, the 95th percentile and the largest of the distances between them in the units of the file; "
      "-o writes the cloud coloured by them. Then what papers compare by: against a mesh distances to the "
      "surface, P2M, shrinkage; against a cloud: Chamfer distance; evenness of the cloud; the error of its "
      "normals if it and the truth (a mesh always) have some. Points that are not finite are left out.";
  command.options = collect(*options);
  command.run = [options](const Invocation& typed) { return run_compare(*options, typed); };
  return command;
}

}  // namespace rfsmooth::cli
