#include "pipeline/cli/console/scale_said.h"

#include <array>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

namespace rfsmooth::cli {

namespace {

std::string scale_text(const std::array<double, 3>& scale) {
  const bool one = scale[0] == scale[1] && scale[1] == scale[2];
  return one ? fmt::format("{:g}", scale[0]) : fmt::format("{:g}", fmt::join(scale, " "));
}

}  // namespace

void tell_scale(const std::string& name, const pipeline::io::RefinedScale& scale, bool kept, double noise,
                std::optional<double> noise_left, Console& console) {
  if (scale.refined())
    console.say(
        fmt::format("{}: scale {} is coarse for noise of {:.3g}: refined to {}{} (--keep-scale keeps it)",
                    name, scale_text(scale.before), noise, scale_text(scale.after),
                    scale.moved_offset() ? ", offset moved" : ""));
  if (scale.coarsest() > pipeline::io::finest_needed(noise, noise_left))
    console.warn(fmt::format(
        "{}: scale {} is coarse for noise of {:.3g}{}", name, scale_text(scale.after), noise,
        kept ? ": rounding to it takes back some of the smoothing (without --keep-scale it would be refined)"
             : ", but 32 bits hold no finer one of so large a cloud"));
}

void warn_of_index(const std::string& output, Console& console) {
  const std::filesystem::path index = std::filesystem::path(output).replace_extension(".lax");
  std::error_code unknown;
  if (std::filesystem::exists(index, unknown))
    console.warn(fmt::format("{}: an index of other points: make it anew", index.string()));
}

}  // namespace rfsmooth::cli
