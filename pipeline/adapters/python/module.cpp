/// The extension module behind the Python package rfsmooth. What users call is written in Python, in
/// rfsmooth/; here is what it stands on. Distinct clouds may be used by several threads at once.
#include <string>
#include <tuple>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <nlohmann/json.hpp>

#include <rfsmooth/compare.h>
#include <rfsmooth/normals.h>
#include <rfsmooth/version.h>

#include "base/parallel.h"
#include "pipeline/adapters/python/cloud.h"
#include "pipeline/adapters/python/option_tables.h"
#include "pipeline/adapters/python/released.h"
#include "pipeline/cli/commands/compare/compare_figures.h"
#include "pipeline/cli/commands/info/info_figures.h"
#include "pipeline/cli/console/report.h"
#include "pipeline/cli/exit_code.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/cli/options/parse.h"
#include "pipeline/cli/program.h"
#include "pipeline/io/formats/las/las_scale.h"
#include "pipeline/io/io.h"
#include "pipeline/normals/normal_sides.h"

namespace rfsmooth::python {

namespace nb = nanobind;
using nlohmann::ordered_json;

namespace {

using Points = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Corners = nb::ndarray<const Index, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
template <class Shape>
using Numbers = nb::ndarray<double, Shape, nb::c_contig, nb::device::cpu>;

std::string text_of(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

/// Does to `cloud` what the sub-command does to a file. \return the report, as JSON.
std::string run_on_cloud(const std::string& name, const OptionTexts& options, pipeline::io::Cloud& cloud,
                         const std::string& input, int threads, const nb::object& progress) {
  const cli::Command command = command_of(name);
  assign_all(command, options);
  ordered_json report = {{"rfsmooth", kVersion}, {"command", name}, {"input", cli::describe(cloud)}};
  released(progress, threads, command.on_cloud.stages(), [&](const Context& context, cli::Console& console) {
    std::vector<StageTime> stages;
    pipeline::io::naming(input, [&] {
      command.on_cloud.work(cloud, {{input, ""}, context, console, stages, report});
      return Done{};
    });
    report["threads"] = threads > 0 ? ordered_json(threads) : ordered_json(nullptr);
    report["seconds"] = cli::json_of(stages);
  });
  return text_of(report);
}

std::string info(const pipeline::io::Cloud& cloud) {
  ordered_json found;
  released(nb::none(), 0, {}, [&](const Context& context, cli::Console&) {
    found = value_or_throw(guarded([&] { return cli::info_of(cloud, context); }));
  });
  return text_of(found);
}

/// Writes the unit normals of `points`, on the side that those `before` were on, if any are given and have
/// sides. \return the report, as JSON.
std::string normals(const Points& points, const Numbers<nb::shape<-1, 3>>& into,
                    const std::optional<std::array<double, 3>>& viewpoint,
                    const std::optional<Points>& before, int threads, const nb::object& progress) {
  NormalsOptions options;
  if (viewpoint) options.viewpoint = Eigen::Vector3d(viewpoint->data());
  NormalsReport done;
  released(progress, threads, {{"normals", 1}}, [&](const Context& context, cli::Console&) {
    done = value_or_throw(
        rfsmooth::estimate_normals(points.data(), points.shape(0), options, context, into.data()));
    if (!before) return;
    value_or_throw(guarded([&] {
      in_arena(context, [&] {
        pipeline::keep_sides(points.data(), points.shape(0), before->data(), into.data(), context);
      });
      return Done{};
    }));
  });
  return text_of({{"points", done.points}, {"finite", done.finite}, {"parts", done.parts}});
}

/// Measures `points` against a true mesh, or a clean cloud, which may have normals, where there are no
/// `faces`; writes each point's deviation. \return the figures, as JSON.
std::string compare(const Points& points, const std::optional<Points>& normals_of_points, const Points& truth,
                    const std::optional<Corners>& faces, const std::optional<Points>& normals_of_truth,
                    bool signed_normals, int threads, const nb::object& progress,
                    const Numbers<nb::ndim<1>>& deviation) {
  const CloudView cloud = {points.data(), points.shape(0),
                           normals_of_points ? normals_of_points->data() : nullptr};
  Truth known;
  if (faces)
    known.mesh =
        MeshView{truth.data(), truth.shape(0), reinterpret_cast<const Face*>(faces->data()), faces->shape(0)};
  else
    known.cloud =
        CloudView{truth.data(), truth.shape(0), normals_of_truth ? normals_of_truth->data() : nullptr};
  ordered_json figures;
  released(progress, threads, {{"compare", 1}}, [&](const Context& context, cli::Console&) {
    const CompareReport report = value_or_throw(rfsmooth::compare(cloud, known, {signed_normals}, context));
    figures = cli::figures_of(report, cli::summed_up(report.deviation));
    std::copy(report.deviation.begin(), report.deviation.end(), deviation.data());
  });
  return text_of(figures);
}

/// The command. Standard output is closed afterwards.
int run_command(const std::vector<std::string>& arguments) {
  std::vector<const char*> argv = {"rfsmooth"};
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  const nb::gil_scoped_release release;
  return cli::run_program(int(argv.size()), argv.data(), cli::all_commands());
}

/// The command's arguments taken apart: the sub-command ("" for none), the files, the options as typed.
std::tuple<std::string, std::vector<std::string>, OptionTexts> parse_command(
    const std::vector<std::string>& arguments) {
  std::vector<const char*> argv = {"rfsmooth"};
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  const std::vector<cli::Command> commands = cli::all_commands();
  cli::Parsed parsed = cli::parse(int(argv.size()), argv.data(), commands);
  return {parsed.command == nullptr ? "" : parsed.command->name, std::move(parsed.invocation.arguments),
          std::move(parsed.invocation.options)};
}

/// The exit code of the command by the name of an error.
nb::dict exit_codes() {
  nb::dict codes;
  for (const cli::ExitCode& exit : cli::kExitCodes)
    if (exit.error) codes[exit.name] = exit.code;
  return codes;
}

/// A Failure becomes rfsmooth.Error.
void raise_error(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Failure& failure) {
    const nb::object type = nb::module_::import_("rfsmooth._error").attr("Error");
    const nb::tuple arguments = nb::make_tuple(cli::exit_of(failure.error.code).name, failure.error.message);
    PyErr_SetObject(type.ptr(), arguments.ptr());
  }
}

}  // namespace

}  // namespace rfsmooth::python

NB_MODULE(_rfsmooth, module) {
  namespace nb = nanobind;
  using namespace rfsmooth::python;
  nb::register_exception_translator(raise_error);
  module.attr("version") = rfsmooth::kVersion;
  module.attr("exit_codes") = exit_codes();
  bind_cloud(module);
  module.def("finest_needed", &rfsmooth::pipeline::io::finest_needed, nb::arg(), nb::arg().none());
  module.def("option_table", &option_table);
  module.def("run_on_cloud", &run_on_cloud, nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg(),
             nb::arg("progress").none());
  module.def("info", &info);
  module.def("normals", &normals, nb::arg(), nb::arg(), nb::arg().none(), nb::arg().none(), nb::arg(),
             nb::arg("progress").none());
  module.def("compare", &compare, nb::arg(), nb::arg().none(), nb::arg(), nb::arg().none(), nb::arg().none(),
             nb::arg(), nb::arg(), nb::arg("progress").none(), nb::arg());
  module.def("parse_command", &parse_command);
  module.def("run_command", &run_command);
}
