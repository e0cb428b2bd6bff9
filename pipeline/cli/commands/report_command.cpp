/// rfsmooth report: a cloud before and after, as a page to look at.
#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/console/console.h"
#include "pipeline/cli/files/cloud_files.h"
#include "pipeline/cli/options/text_values.h"
#include "pipeline/cli/other_program.h"
#include "pipeline/cli/own_files.h"
#include "pipeline/page/page.h"
#include "pipeline/prepare.h"

namespace rfsmooth::cli {

namespace {

struct ReportCommandOptions {
  std::optional<std::string> output;
  std::string points = "300000";
  bool force = false;
  ConsoleOptions console;

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
    ConsoleOptions::describe(self.console, visit);
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

/// The flags that `denoise --outliers mark` leaves; empty if there are none.
std::vector<char> marked_outliers(const pipeline::io::Cloud& cloud, const Context& context) {
  const auto field = pipeline::io::find_plain_field(cloud, "outlier");
  if (!field) return {};
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
  const pipeline::Measured measured = pipeline::io::naming(typed.arguments[0], [&] {
    return pipeline::measure_points(contents.before.xyz, Outliers::keep, {}, context);
  });
  if (contents.outlier.empty()) contents.outlier = measured.outlier;
  contents.figures = {
      {"outliers", fmt::format("{}", std::count(contents.outlier.begin(), contents.outlier.end(), 1))},
      {"spacing before", fmt::format("{:.4g}", *measured.statistics.spacing)},
      {"noise before", fmt::format("{:.3g}", measured.statistics.noise->sigma)}};
  return contents;
}

int run_report(const ReportCommandOptions& options, const Invocation& typed, const std::string& line) {
  if (typed.arguments.size() != 2) fail(ErrorCode::usage, "two files are needed: the cloud before and after");
  need_one_standard_input(typed.arguments);
  if (!options.output) fail(ErrorCode::usage, "no page named: -o OUT.html");
  const std::size_t points = read_points(options.points);
  check_no_cloud_target(*options.output, options.force, "page");
  Console console(options.console);
  const Context context = console.context({{"read", 1}});
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
  command.options = collect(*options);
  command.run = [options, known = command.options](const Invocation& typed) {
    return run_report(*options, typed, command_line("report", typed, known));
  };
  return command;
}

}  // namespace rfsmooth::cli
