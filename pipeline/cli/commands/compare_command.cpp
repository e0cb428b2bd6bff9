/// rfsmooth compare: a cloud against the truth, a mesh or a clean cloud.
#include <memory>

#include <fmt/format.h>

#include <rfsmooth/compare.h>

#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/console.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/io/mesh_file.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

struct CompareCommandOptions {
  bool signed_normals = false;
  bool json = false;
  std::optional<int> threads;
  TalkOptions talk;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"signed-normals", "the cloud's normals claim a side: angles up to 180 degrees", ""},
          self.signed_normals);
    visit(OptionInfo{"json", "print JSON", ""}, self.json);
    visit(OptionInfo{"threads", "threads to use; auto: all cores; the result is the same", "", 1, 1024},
          self.threads);
    TalkOptions::describe(self.talk, visit);
  }
};

struct ToJson {
  ordered_json& out;
  void operator()(const MeasureInfo& info, const std::optional<double>& value) {
    if (value) out[std::string(info.name)] = *value;
  }
};

struct ToText {
  const ordered_json& on_unit_sphere;
  void operator()(const MeasureInfo& info, const std::optional<double>& value) {
    if (!value) return;
    std::string scaled;
    if (info.length_power > 0)
      scaled = fmt::format("{:.5g}", on_unit_sphere[std::string(info.name)].get<double>() * 1e4);
    fmt::print("{:<21} {:>12.6g} {:>12}  {}\n", info.name, *value, scaled, info.help);
  }
};

std::vector<double> normals_of(const pipeline::io::Cloud& cloud, const Context& context) {
  for (const auto& names : {std::array{"nx", "ny", "nz"}, std::array{"normal_x", "normal_y", "normal_z"}}) {
    std::vector<double> normals(3 * cloud.size());
    bool all = true;
    for (std::size_t axis = 0; axis < 3 && all; ++axis) {
      const auto field = pipeline::io::find_field(cloud, names[axis]);
      all = field && cloud.points().fields[*field].is_plain();
      if (!all) break;
      const std::vector<double> values = pipeline::io::field_values(cloud, *field, context);
      for (std::size_t i = 0; i < values.size(); ++i) normals[3 * i + axis] = values[i];
    }
    if (all) return normals;
  }
  return {};
}

int run_compare(const CompareCommandOptions& options, const Invocation& typed) {
  if (typed.arguments.size() != 2)
    throw Failure(
        {ErrorCode::usage, "two files are needed: the cloud and the truth (a mesh or a clean cloud)"});
  Console console(options.talk);
  const Context context = console.context(options.threads.value_or(0));
  std::vector<StageTime> unused;
  const auto cloud = load_cloud(typed.arguments[0], context, unused);
  const auto truth_file = load_cloud(typed.arguments[1], context, unused);

  const std::vector<double> xyz = pipeline::io::positions(cloud, context),
                            normals = normals_of(cloud, context);
  const std::vector<double> truth_xyz = pipeline::io::positions(truth_file, context);
  const std::vector<Face> faces = pipeline::io::faces_of(truth_file, context);
  Truth truth;
  if (faces.empty())
    truth.cloud = CloudView{truth_xyz.data(), truth_file.size(), nullptr};
  else
    truth.mesh = MeshView{truth_xyz.data(), truth_file.size(), faces.data(), faces.size()};
  CompareOptions compare_options;
  compare_options.signed_normals = options.signed_normals;
  const CompareReport report =
      value_or_throw(rfsmooth::compare({xyz.data(), cloud.size(), normals.empty() ? nullptr : normals.data()},
                                       truth, compare_options, context));

  ordered_json own, unit;
  Measures::describe(report.own_units, ToJson{own});
  const Measures scaled = rfsmooth::on_unit_sphere(report.own_units, report.radius);
  Measures::describe(scaled, ToJson{unit});
  if (options.json) {
    const ordered_json json = {{"cloud", typed.arguments[0]},
                               {"truth", typed.arguments[1]},
                               {"points", report.points},
                               {"finite", report.finite},
                               {"truth_points", report.truth_points},
                               {"truth_faces", report.truth_faces},
                               {"truth_closed", report.truth_closed},
                               {"radius", report.radius},
                               {"own_units", own},
                               {"unit_sphere", unit}};
    fmt::print("{}\n", json.dump(2, ' ', false, ordered_json::error_handler_t::replace));
    return 0;
  }
  fmt::print("{} points ({} finite) against {} {}\n", report.points, report.finite,
             faces.empty() ? report.truth_points : report.truth_faces,
             faces.empty() ? "clean points" : "true faces");
  fmt::print("{:<21} {:>12} {:>12}  {}\n", "", "own units", "x 1e4", "(x 1e4: on the truth's unit sphere)");
  Measures::describe(report.own_units, ToText{unit});
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
      "TRUTH is a mesh (PLY with faces, OFF) or a clean cloud. Against a mesh: distances to the surface, "
      "P2M, "
      "shrinkage; against a cloud: Chamfer distance; evenness of the cloud; the error of its normals if it "
      "has "
      "some. Points that are not finite are left out.";
  collect(*options, command.options);
  polish(command);
  command.run = [options](const Invocation& typed) { return run_compare(*options, typed); };
  return command;
}

}  // namespace rfsmooth::cli
