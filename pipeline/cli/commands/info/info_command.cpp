/// rfsmooth info: what a file holds.
#include <memory>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/commands/info/info_figures.h"
#include "pipeline/cli/console/console.h"
#include "pipeline/cli/console/report.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/io/json_file.h"
#include "pipeline/tiles/files/statistics_json.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

struct InfoCommandOptions {
  bool json = false;
  ConsoleOptions console;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"json", "print JSON", ""}, self.json);
    ConsoleOptions::describe(self.console, visit);
  }
};

std::string vector_text(const ordered_json& v, int digits = 9) {
  return fmt::format("{:.{}g} {:.{}g} {:.{}g}", v[0].get<double>(), digits, v[1].get<double>(), digits,
                     v[2].get<double>(), digits);
}

void print_las(const ordered_json& las) {
  fmt::print("  LAS       {}, point format {}, scale {}, offset {}\n", las["version"].get<std::string>(),
             las["point_format"].get<int>(), vector_text(las["scale"], 17), vector_text(las["offset"], 17));
  for (const auto& record : las["records"])
    fmt::print("  record    {} {}: {}{}\n", record["user"].get<std::string>(), record["id"].get<int>(),
               counted(record["bytes"].get<std::size_t>(), "byte"),
               record["extended"].get<bool>() ? ", behind the points" : "");
}

void print_text(const ordered_json& info) {
  const auto text = [&](const char* key) { return info[key].get<std::string>(); };
  const auto count = [&](const char* key) { return info[key].get<std::size_t>(); };
  fmt::print("{}: {} {}\n", text("path"), text("format"), text("encoding"));
  fmt::print("  points    {} ({} finite, {} distinct)\n", count("points"), count("finite"),
             count("distinct"));
  if (info["organised"].get<bool>())
    fmt::print("  organised {} x {}\n", count("width"), count("height"));
  else
    fmt::print("  organised no\n");
  if (!info["low"].is_null()) {
    fmt::print("  low       {}\n  high      {}\n", vector_text(info["low"]), vector_text(info["high"]));
    std::vector<double> size;
    for (std::size_t axis = 0; axis < 3; ++axis)
      size.push_back(info["high"][axis].get<double>() - info["low"][axis].get<double>());
    fmt::print("  extent    {:.6g}\n", fmt::join(size, " "));
  }
  if (!info["spacing"].is_null())
    fmt::print("  spacing   {:.6g} (mean distance to the nearest other point; {} from dense to sparse)\n",
               info["spacing"].get<double>(), vector_text(info["spacing_field"], 6));
  if (!info["noise"].is_null()) {
    const NoiseSummary measured = pipeline::tiles::summary_of(info["noise_measured"]);
    const double noise = info["noise"];
    const std::string shape = beside_shape(noise, measured.typical, info["spacing"]);
    fmt::print(
        "  noise     {:.6g}{}{}{} (standard deviation along the normal; over the cloud {} from calm to "
        "loud)\n",
        noise, shape.empty() ? "" : ", ", shape, in_words(measured), vector_text(info["noise_field"], 6));
  }
  fmt::print("  fields   ");
  for (const auto& field : info["fields"]) {
    fmt::print(" {}:{}", field["name"].get<std::string>(), field["type"].get<std::string>());
    if (field.contains("count")) fmt::print("[{}]", field["count"].get<std::size_t>());
    if (field.contains("list")) fmt::print("[]");
  }
  fmt::print("\n");
  if (info.contains("las")) print_las(info["las"]);
  if (info.contains("elements"))
    for (const auto& element : info["elements"])
      fmt::print("  element   {} x {}\n", element["name"].get<std::string>(),
                 element["count"].get<std::size_t>());
}

int run_info(const InfoCommandOptions& options, const Invocation& typed) {
  if (typed.arguments.empty()) fail(ErrorCode::usage, "no input given");
  need_one_standard_input(typed.arguments);
  Console console(options.console);
  const Context context = console.context({{"read", 1}});
  auto all = ordered_json::array();
  std::vector<Job> jobs;
  for (const std::string& input : typed.arguments) jobs.push_back({input, ""});
  const int code = run_jobs(jobs, console, [&](const Job& job) -> std::optional<Error> {
    const auto done = guarded([&] {
      const pipeline::io::Cloud cloud = load_cloud(job.input, context);
      ordered_json info = {{"path", job.input}};
      info.update(info_of(cloud, context));
      if (!info["spacing"].is_null())
        warn_if_coarse(cloud, pipeline::io::positions(cloud, context), info["spacing"], job.input, console);
      return info;
    });
    if (!done.ok()) return done.error();
    if (!options.json) print_text(done.value());
    all.push_back(done.value());
    return std::nullopt;
  });
  if (options.json && !all.empty()) fmt::print("{}", pipeline::io::in_lines(jobs.size() == 1 ? all[0] : all));
  return code;
}

}  // namespace

Command info_command() {
  auto options = std::make_shared<InfoCommandOptions>();
  Command command;
  command.name = "info";
  command.summary = "say what a file holds: fields, points, extent, spacing";
  command.usage = {"[options] IN..."};
  command.description =
      "Prints format, fields with their types, points (finite, distinct), whether they are "
      "organised, extent, spacing and noise. - stands for standard input.\n\n"
      "Spacing and noise are measured as denoise does: outliers have no part in them, and twins are one. "
      "The noise is that of the typical place, 0 where all that is measured could as well be small shape, "
      "which is then named beside it. Where there is more to say, it follows: 'S in the loudest tenth' is "
      "the noise that a tenth of the points exceed. 'shared by N neighbours': neighbours err "
      "together, as in the blotches of depth cameras, and N of them tell no more than one; smoothing takes "
      "so many points more together. 'points along lines': the nearest of a point are on one line, as on "
      "the rings of a spinning laser; smoothing follows the lines. 'depth in steps of S': depths are "
      "rounded, and S is the typical distance from one to the next. 'points on a grid of S': most are S "
      "from their nearest, as the centres of voxels are. Of what smoothing left next to nothing is seen: "
      "there neighbours are off by the same, as if it were shape; denoise says how much that is.";
  command.options = collect(*options);
  command.run = [options](const Invocation& typed) { return run_info(*options, typed); };
  return command;
}

}  // namespace rfsmooth::cli
