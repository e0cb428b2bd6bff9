#include "pipeline/cli/commands/denoise/summary.h"

#include <stdexcept>
#include <variant>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/console/report.h"
#include "rfs_mesh/noise/noise.h"

namespace rfsmooth::cli {

namespace {

/// "; 3 outliers removed", or nothing.
std::string said_of_outliers(const DenoiseReport& done, const DenoiseCommandOptions& options) {
  if (done.outliers == 0) return "";
  const char* what = options.removes() ? "removed" : options.marks() ? "marked" : "left in place";
  return fmt::format("; {} {}", counted(done.outliers, "outlier"), what);
}

/// Why nothing was smoothed, or nothing. `stated`: the noise was, and is not what the cloud shows.
std::string why_not(const DenoiseReport& done, bool stated) {
  if (!done.not_smoothed) return "";
  switch (*done.not_smoothed) {
    case NotSmoothed::no_iterations:
      return "not smoothed, as --iterations 0 asks";
    case NotSmoothed::no_strength:
      return "not smoothed, as --strength 0 asks";
    case NotSmoothed::too_few_points:
      return "too few points to smooth";
    case NotSmoothed::too_little_noise: {
      if (stated && done.noise == 0) return "nothing to smooth";
      const std::string shape = beside_shape(done.noise, done.measured.typical, done.spacing);
      if (shape.empty() && nearly_exact(done.noise, done.spacing)) return "too little to smooth";
      return fmt::format("{}{}too little to smooth (--strength 2 does it all the same)", shape,
                         shape.empty() ? "" : ", ");
    }
  }
  throw std::invalid_argument("why_not: not a NotSmoothed");
}

/// ", as stated" of noise that was; else what there is to say of what was measured, and what it became.
std::string said_of_noise(const DenoiseReport& done, const DenoiseCommandOptions& options) {
  const auto* typed = std::get_if<AutomaticOptions>(&options.denoise.flow.flow);
  const bool stated = typed != nullptr && typed->noise;
  std::string words = stated ? ", as stated" : "";
  if (const std::string why = why_not(done, stated); !why.empty()) return words + ", " + why;
  if (!stated) words += in_words(done.measured);
  if (done.tail_times > 1) words += fmt::format(", some points {:.2g} times that", done.tail_times);
  if (done.noise_left && *done.noise_left < done.noise)
    words += fmt::format(", about {:.3g} left", *done.noise_left);
  return words;
}

}  // namespace

void tell_points(const DenoiseReport& done, const DenoiseCommandOptions& options, bool had_normals,
                 bool as_las, const Job& job, Console& console) {
  if (done.finite < done.points)
    console.detail(fmt::format("{}: not finite: {}, {}", job.input,
                               counted(done.points - done.finite, "point"),
                               as_las ? "which LAS cannot hold" : "kept unchanged"));
  if (done.moved > 0 && had_normals && !options.normals.normals)
    console.warn(fmt::format(
        "{}: the normals are stale: they describe the old positions (--normals makes new ones)", job.input));
}

std::string summary(const DenoiseReport& done, const DenoiseCommandOptions& options,
                    const std::string& with_outliers) {
  return fmt::format("{}, {} finite{}{}\nnoise {:.3g}{}; spacing {:.4g}\nlargest move {:.4g}, rms {:.4g}",
                     counted(done.points, "point"), done.finite, said_of_outliers(done, options),
                     with_outliers, done.noise, said_of_noise(done, options), done.spacing, done.largest_move,
                     done.rms_move);
}

}  // namespace rfsmooth::cli
