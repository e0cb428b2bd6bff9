/// rfsmooth report: a cloud before and after, as a page to look at.
#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/console/console.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/cli/options/text_values.h"
#include "pipeline/cli/other_program.h"
#include "pipeline/cli/own_files.h"
#include "pipeline/outliers.h"
#include "pipeline/page/page.h"
#include "pipeline/twins.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::cli {

namespace {

struct ReportCommandOptions {
  std::optional<std::string> output;
  std::string points = "300000";
  bool force = false;
  std::optional<int> threads;
  TalkOptions talk;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"output", "the page, HTML", "file"}, self.output);
    visit(
        OptionInfo{
            "points",
            "how many to show at most, or all; three quarters are chosen evenly, the others moved farthest",
            ""},
        self.points);
    visit(OptionInfo{"force", "replace an existing file", ""}, self.force);
    visit(threads_option(), self.threads);
    TalkOptions::describe(self.talk, visit);
  }
};

/// \throw Failure (usage).
std::size_t read_points(const std::string& text) {
  if (text == "all") return pipeline::kAllPoints;
  const auto count = read_count(text);
  if (!count || *count < 1)
    fail(ErrorCode::usage, "--points is '{}'; it must be 'all' or a number from 1 on", text);
  return std::size_t(*count);
}

/// What is known of a cloud beside its coordinates.
struct Measured {
  double spacing = 0, noise = 0;
  std::vector<char> outlier;  ///< n flags; empty if they were not asked for
};

Measured measure_cloud(const std::vector<double>& xyz, bool outliers, const Context& context) {
  auto cloud = value_or_throw(rfs_mesh::make_working_cloud(xyz.data(), xyz.size() / 3, context));
  Measured measured;
  in_arena(context, [&] {
    std::optional<rfs_mesh::SpatialIndex> searched(std::in_place, cloud.points, context);
    const rfs_mesh::NeighborTable near =
        pipeline::nearest_joined(searched, cloud, ConnectOptions().neighbours, context);
    const rfs_mesh::SpatialIndex& index = *searched;
    if (cloud.points.size() > 1) measured.spacing = rfs_mesh::mean_spacing(cloud.points, near, context);
    Statistics whole;
    whole.box = cloud.box;
    pipeline::find_noise(index, near, whole, context);
    measured.noise = whole.noise->sigma;
    if (!outliers) return;
    const std::vector<char> found = pipeline::find_outliers(index, near, whole, context);
    measured.outlier.assign(xyz.size() / 3, 0);
    for (std::size_t row = 0; row < measured.outlier.size(); ++row)
      if (const Index p = cloud.of_input[row]; p != kNone) measured.outlier[row] = found[p];
  });
  return measured;
}

/// The flags that `denoise --outliers mark` leaves; empty if there are none.
std::vector<char> marked_outliers(const pipeline::io::Cloud& cloud, const Context& context) {
  const auto field = pipeline::io::find_field(cloud, "outlier");
  if (!field || !cloud.points().fields[*field].is_plain()) return {};
  std::vector<char> flags(cloud.size());
  const std::vector<double> values = pipeline::io::field_values(cloud, *field, context);
  for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = char(values[i] != 0);
  return flags;
}

/// The contents of the page, for clouds of the same size.
pipeline::PageContents contents_of(const pipeline::io::Cloud& before, const pipeline::io::Cloud& after,
                                   const Invocation& typed, const Context& context) {
  pipeline::PageContents contents = pipeline::page_before(typed.arguments[0], before, context);
  contents.after = pipeline::page_side(typed.arguments[1], after, context);
  contents.outlier = marked_outliers(after, context);
  const Measured measured = measure_cloud(contents.before.xyz, contents.outlier.empty(), context);
  if (contents.outlier.empty()) contents.outlier = measured.outlier;
  contents.figures = {
      {"outliers", fmt::format("{}", std::count(contents.outlier.begin(), contents.outlier.end(), 1))},
      {"spacing before", fmt::format("{:.4g}", measured.spacing)},
      {"noise before", fmt::format("{:.3g}", measured.noise)}};
  return contents;
}

int run_report(const ReportCommandOptions& options, const Invocation& typed, const std::string& line) {
  if (typed.arguments.size() != 2) fail(ErrorCode::usage, "two files are needed: the cloud before and after");
  if (!options.output) fail(ErrorCode::usage, "no page named: -o OUT.html");
  const std::size_t points = read_points(options.points);
  check_no_cloud_target(*options.output, options.force, "page");
  Console console(options.talk);
  const Context context = console.context({{"read", 1}}, options.threads);
  const auto before = load_cloud(typed.arguments[0], context),
             after = load_cloud(typed.arguments[1], context);
  pipeline::need_same_size(typed.arguments[0], before.size(), typed.arguments[1], after.size());
  pipeline::PageContents contents = contents_of(before, after, typed, context);
  contents.points = points;
  contents.command = line;
  const std::string page = pipeline::make_page(contents, context);
  value_or_throw(pipeline::io::write_bytes(page, *options.output, options.force, context));
  console.say(fmt::format("{}: {:.1f} MB, open it in a browser", *options.output, double(page.size()) / 1e6));
  return 0;
}

}  // namespace

Command report_command() {
  auto options = std::make_shared<ReportCommandOptions>();
  Command command;
  command.name = "report";
  command.summary = "make a page to look at: a cloud before and after";
  command.usage = {"[options] BEFORE AFTER -o OUT.html"};
  command.description =
      "BEFORE and AFTER are files of the same points in the same order, as denoise leaves them. The page is "
      "one HTML file that loads nothing: a slider between before and after, the points shaded, in their own "
      "colours, by how far they moved or with the outliers marked, a cross-section, the figures, and a "
      "histogram of the displacements. A field 'outlier' of AFTER says which points are outliers; else they "
      "are searched for. rfsmooth denoise --html makes the same page on the way.";
  collect(*options, command.options);
  command.run = [options, known = command.options](const Invocation& typed) {
    return run_report(*options, typed, command_line("report", typed, known));
  };
  return command;
}

}  // namespace rfsmooth::cli
