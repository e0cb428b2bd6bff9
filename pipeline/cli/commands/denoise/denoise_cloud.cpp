#include "pipeline/cli/commands/denoise/denoise_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/commands/denoise/summary.h"
#include "pipeline/cli/commands/denoise/within_memory.h"
#include "pipeline/cli/console/report.h"
#include "pipeline/cli/console/scale_said.h"
#include "pipeline/cli/console/solver_said.h"
#include "pipeline/cli/files/constraint_fields.h"
#include "pipeline/cli/files/memory.h"
#include "pipeline/denoise_lean.h"
#include "pipeline/io/formats/las/las_scale.h"
#include "pipeline/io/json_file.h"
#include "pipeline/io/point_fields.h"
#include "pipeline/page/page.h"
#include "pipeline/page/shown.h"
#include "pipeline/tiles/files/statistics_json.h"
#include "pipeline/tiles/steps/settle.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

constexpr const char *kDisplacement = "displacement", *kOutlier = "outlier";

/// Refuses fields that could not be added, before the work. \throw Failure.
void check_fields(const DenoiseCommandOptions& options, const pipeline::io::Cloud& cloud) {
  for (const pipeline::io::Field& field : added_fields(options))
    pipeline::io::check_field(cloud, field.name, field.type);
  check_normals(options.normals, cloud);
}

/// How outliers leave the cloud.
enum class Leaving {
  none,     ///< they stay, or there are none
  as_rows,  ///< their rows are dropped, the others in their order
  as_nan    ///< they become NaN, as a sensor writes where it saw nothing, so that the cloud keeps its grid
};

/// Whether the coordinates can say that nothing was seen.
bool can_be_nan(const pipeline::io::Cloud& cloud) {
  bool has_nan = true;
  for (const std::size_t f : cloud.xyz) has_nan = has_nan && is_float(cloud.points().fields[f].type);
  return has_nan;
}

Leaving way_out(const DenoiseCommandOptions& options, const DenoiseReport& done,
                const pipeline::io::Cloud& cloud) {
  if (!options.removes() || done.outliers == 0) return Leaving::none;
  return cloud.organised() && can_be_nan(cloud) ? Leaving::as_nan : Leaving::as_rows;
}

/// What became of a cloud, which itself still has its old positions.
struct Smoothed {
  DenoiseReport report;
  Leaving leaving = Leaving::none;
  std::vector<double> xyz;      ///< n x 3
  std::vector<double> staying;  ///< the same with NaN for outliers that leave; empty where none does

  /// Those that the cloud gets. Rows that are to be dropped have numbers until then: coordinates that are
  /// whole numbers hold no NaN.
  const std::vector<double>& for_cloud() const { return leaving == Leaving::as_nan ? staying : xyz; }
  /// Those that normals are made of.
  const std::vector<double>& of_staying() const { return leaving == Leaving::none ? xyz : staying; }
};

/// The positions with NaN for outliers.
std::vector<double> without_outliers(std::vector<double> xyz, const std::vector<char>& outlier) {
  for (std::size_t i = 0; i < outlier.size(); ++i)
    if (outlier[i] != 0) std::fill_n(&xyz[3 * i], 3, std::numeric_limits<double>::quiet_NaN());
  return xyz;
}

/// `xyz`: the positions of the cloud.
Smoothed smooth(const DenoiseCommandOptions& options, const pipeline::io::Cloud& cloud,
                std::vector<double> xyz, const CloudTask& task) {
  std::vector<double> strength;
  if (options.strength_field) strength = strengths(cloud, *options.strength_field, task.context);
  DenoiseOptions how = options.denoise;
  how.flow.trace = options.trace.trace.has_value();
  if (options.statistics)
    how.statistics = pipeline::tiles::read_settled(*options.statistics).report.statistics;
  Smoothed smoothed;
  const auto again = [&] { return pipeline::io::positions(cloud, task.context); };
  smoothed.report = value_or_throw(pipeline::denoise_lean(xyz, again, how, task.context, strength));
  smoothed.xyz = std::move(xyz);
  smoothed.leaving = way_out(options, smoothed.report, cloud);
  if (smoothed.leaving != Leaving::none)
    smoothed.staying = without_outliers(smoothed.xyz, smoothed.report.outlier);
  return smoothed;
}

bool is_written_as_las(const DenoiseCommandOptions& options, const pipeline::io::Cloud& cloud,
                       const Job& job) {
  return output_format(cloud, job.output, options.job.files) == pipeline::io::Format::las;
}

/// Refines the scale of a LAS cloud, and says so. For LAS to be written as far as it is coarse for what is
/// left of the noise. For other formats, which have no steps, as far as 32 bits go.
void refine_scale(const DenoiseCommandOptions& options, const DenoiseReport& done, pipeline::io::Cloud& cloud,
                  const std::vector<double>& xyz, const CloudTask& task) {
  using pipeline::io::Format;
  const auto& [job, context, console, stages, entry] = task;
  if (done.moved == 0 || cloud.format != Format::las) return;
  if (!is_written_as_las(options, cloud, job)) {
    pipeline::io::refine_scale(cloud, std::numeric_limits<double>::min(), xyz.data(), context);
    return;
  }
  if (done.noise <= 0) return;
  const double step = pipeline::io::finest_asked(options.keep_scale, done.noise, done.noise_left);
  const pipeline::io::RefinedScale scale = pipeline::io::refine_scale(cloud, step, xyz.data(), context);
  entry["scale"] = {{"before", scale.before}, {"after", scale.after}};
  tell_scale(job.input, scale, options.keep_scale, done.noise, done.noise_left, console);
}

/// What is left of the noise, with that of rounding coordinates to their steps.
void add_rounding(const pipeline::io::Cloud& cloud, DenoiseReport& done) {
  if (done.moved == 0 || !done.noise_left) return;
  double step = 0;
  for (const std::size_t f : cloud.xyz) step = std::max(step, cloud.points().fields[f].step());
  done.noise_left = pipeline::io::with_rounding(*done.noise_left, step);
}

/// Gives the points new positions and, if asked for, the field of how far that moved them, as the file now
/// has them: rounded to the coordinates' own type. 0 for points that are not finite.
void move_points(const DenoiseCommandOptions& options, pipeline::io::Cloud& cloud,
                 const std::vector<double>& xyz, const Context& context) {
  if (!options.write_displacement) return pipeline::io::set_positions(cloud, xyz.data(), context);
  const std::vector<double> before = pipeline::io::positions(cloud, context);
  pipeline::io::set_positions(cloud, xyz.data(), context);
  std::vector<double> distance = pipeline::displacements(before, pipeline::io::positions(cloud, context));
  for (double& d : distance)
    if (!std::isfinite(d)) d = 0;
  pipeline::io::set_field(cloud, kDisplacement, pipeline::io::Scalar::float32, distance, context);
}

/// Adds the field of outliers. `outlier`: one for each point, or empty.
void mark_outliers(pipeline::io::Cloud& cloud, const std::vector<char>& outlier, const Context& context) {
  std::vector<double> flags(outlier.begin(), outlier.end());
  flags.resize(cloud.size(), 0);
  pipeline::io::set_field(cloud, kOutlier, pipeline::io::Scalar::uint8, flags, context);
}

/// An organised cloud whose coordinates have no NaN has no way to say that a place of its grid is empty.
void warn_of_grid(const Job& job, const pipeline::io::Cloud& cloud, Console& console) {
  if (cloud.organised())
    console.warn(
        fmt::format("{}: the coordinates are whole numbers, which cannot say that nothing was seen: with the "
                    "outliers the grid of {} x {} goes, too (--outliers mark keeps it)",
                    job.input, cloud.width, cloud.height));
}

/// \return ", with them 5 of 12 faces": what touched them and is gone, too; or nothing.
std::string drop_outliers(pipeline::io::Cloud& cloud, const std::vector<char>& outlier,
                          const CloudTask& task) {
  std::vector<std::size_t> rows, counts;
  for (std::size_t i = 0; i < outlier.size(); ++i)
    if (outlier[i] == 0) rows.push_back(i);
  for (const auto& element : cloud.elements) counts.push_back(element.count);
  pipeline::io::select_points(cloud, rows, task.context);
  std::string said;
  for (std::size_t e = 0; e < counts.size(); ++e) {
    const auto& element = cloud.elements[e];
    if (e == cloud.vertex || element.count == counts[e]) continue;
    const std::size_t gone = counts[e] - element.count;
    task.entry["counts"]["removed_with_points"][element.name] = gone;
    const char* const plural = !element.name.empty() && element.name.back() == 's' ? "" : "s";  // tristrips
    said += fmt::format("{} {} of {} {}{}", said.empty() ? ", with them" : ",", gone, counts[e], element.name,
                        plural);
  }
  return said;
}

void enter(const DenoiseReport& done, const DenoiseCommandOptions& options, ordered_json& entry) {
  DenoiseCommandOptions used = options;
  used.denoise = done.effective;
  used.html.reset();  // what is written beside the cloud is not how it was made
  used.trace.trace.reset();
  used.memory.reset();  // nor is the memory it was made in
  entry["options"] = effective_options(used, options.job.files);
  entry["counts"] = {{"points", done.points},       {"finite", done.finite},    {"distinct", done.distinct},
                     {"moved", done.moved},         {"faces", done.faces},      {"edges", done.edges},
                     {"sdg_edges", done.sdg_edges}, {"bridges", done.bridges},  {"faceless", done.faceless},
                     {"swaps", done.swaps},         {"stranded", done.stranded}};
  entry["counts"]["outliers"] = done.outliers;
  entry["counts"]["removed"] = options.removes() ? done.outliers : 0;
  entry["spacing"] = done.spacing;
  entry["noise"] = done.noise;
  entry["noise_measured"] = pipeline::tiles::json_of(done.measured);
  entry["noise_left"] = pipeline::io::or_null(done.noise_left);
  entry["not_smoothed"] = pipeline::tiles::json_of(done.not_smoothed);
  entry["guide_strength"] = done.guide_strength;
  entry["tail_times"] = done.tail_times;
  entry["equalized"] = {{"rms", done.equalized_rms}, {"largest", done.equalized_largest}};
  entry["solver"] = json_of(done.solver);
  entry["largest_move"] = done.largest_move;
  entry["rms_move"] = done.rms_move;
}

void tell(const DenoiseReport& done, const DenoiseCommandOptions& options, const pipeline::io::Cloud& cloud,
          const CloudTask& task) {
  tell_points(done, options, pipeline::io::has_normals(cloud), is_written_as_las(options, cloud, task.job),
              task.job, task.console);
  tell_solver(task.job.input, done.solver, task.console);
  task.console.detail(fmt::format("{}, {}, {}, {} without a face, {}", counted(done.faces, "face"),
                                  counted(done.edges, "edge"), counted(done.bridges, "bridge"),
                                  counted(done.faceless, "point"), counted(done.swaps, "swap")));
}

/// Adds to the page what became of the cloud; its normals only if they are of the new surface. Outliers that
/// are to be removed are still rows of it: the page shows them on one side.
void page_after(const DenoiseReport& done, const DenoiseCommandOptions& options,
                const pipeline::io::Cloud& cloud, const Job& job, const Context& context,
                pipeline::PageContents& contents) {
  contents.after = pipeline::page_side(job.output, cloud, context);
  if (!options.normals.normals) contents.after.normals.clear();
  contents.outlier = done.outlier;
  if (options.removes()) contents.after.xyz = without_outliers(std::move(contents.after.xyz), done.outlier);
  contents.figures = {{"outliers", std::to_string(done.outliers)},
                      {"spacing", fmt::format("{:.4g}", done.spacing)},
                      {"noise", fmt::format("{:.3g}", done.noise)}};
  if (done.noise_left && *done.noise_left < done.noise)
    contents.figures.emplace_back("about left of it", fmt::format("{:.3g}", *done.noise_left));
}

}  // namespace

std::vector<pipeline::io::Field> added_fields(const DenoiseCommandOptions& options) {
  std::vector<pipeline::io::Field> added;
  if (options.write_displacement) added.push_back({kDisplacement, pipeline::io::Scalar::float32});
  if (options.marks()) added.push_back({kOutlier, pipeline::io::Scalar::uint8});
  return added;
}

std::string denoise_cloud(const DenoiseCommandOptions& options, Beside& beside, pipeline::io::Cloud& cloud,
                          const CloudTask& task) {
  const auto& [job, context, console, stages, entry] = task;
  check_fields(options, cloud);
  need_memory(rfsmooth::denoise_memory(cloud.size()));
  std::vector<double> xyz = pipeline::io::positions(cloud, context);
  check_memory(options, job, xyz, context);
  Smoothed smoothed = smooth(options, cloud, std::move(xyz), task);
  DenoiseReport& done = smoothed.report;

  // The cloud has its old positions here, which the page shows on one side.
  pipeline::PageContents page;
  if (options.html) page = pipeline::page_before(job.input, cloud, context);
  warn_if_coarse(cloud, pipeline::io::positions(cloud, context), done.spacing, job.input, console);

  // The scale comes first: positions are rounded to its steps.
  refine_scale(options, done, cloud, smoothed.xyz, task);
  add_rounding(cloud, done);
  if (is_written_as_las(options, cloud, job)) warn_of_index(job.output, console);
  move_points(options, cloud, smoothed.for_cloud(), context);
  if (options.marks()) mark_outliers(cloud, done.outlier, context);
  stages.insert(stages.end(), done.seconds.begin(), done.seconds.end());
  tell(done, options, cloud, task);
  enter(done, options, entry);
  write_normals(options.normals, cloud, smoothed.of_staying().data(), options.job.files, task);

  // Rows are dropped last: until here row i of all arrays and of the page's other side is the same point.
  if (options.html) {
    page_after(done, options, cloud, job, context, page);
    page.command = beside.command;
    beside.page = pipeline::make_page(page, context);
  }
  std::string with_outliers;
  if (smoothed.leaving == Leaving::as_rows) {
    warn_of_grid(job, cloud, console);
    with_outliers = drop_outliers(cloud, done.outlier, task);
  }
  beside.trace = std::move(smoothed.report.trace);
  return summary(done, options, with_outliers);
}

}  // namespace rfsmooth::cli
