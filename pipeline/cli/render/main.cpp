/// rfsmooth-render: what `rfsmooth render` becomes.
#include <fmt/format.h>

#include "base/fail.h"
#include "clouds/render/picture.h"
#include "pipeline/cli/commands/render_command.h"
#include "pipeline/cli/options/text_values.h"
#include "pipeline/cli/program.h"
#include "pipeline/io/io.h"

namespace {

using rfsmooth::cli::RenderOptions;

std::optional<Eigen::Vector3d> three(const char* option, const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  auto values = rfsmooth::cli::read_point(*text);
  if (!values)
    rfsmooth::fail(rfsmooth::ErrorCode::usage, "--{}: expected three numbers as 1,0,0; found '{}'", option,
                   *text);
  return values;
}

/// What stands between the commas.
std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> found(1);
  for (const char c : text)
    if (c == ',')
      found.emplace_back();
    else
      found.back() += c;
  return found;
}

rfsmooth::render::PictureOptions picture_options(const RenderOptions& options,
                                                 const std::vector<std::string>& inputs) {
  rfsmooth::render::PictureOptions out;
  out.inputs = inputs;
  if (options.labels) out.labels = parts(*options.labels);
  if (out.labels.size() > inputs.size())
    rfsmooth::fail(rfsmooth::ErrorCode::usage, "--labels has {} for {}",
                   rfsmooth::counted(out.labels.size(), "text"), rfsmooth::counted(inputs.size(), "input"));
  out.title = options.title.value_or("");
  out.direction = three("direction", options.direction);
  out.up = three("up", options.up);
  out.zoom = three("zoom", options.zoom);
  out.style = options.style;
  return out;
}

void draw(const RenderOptions& options, const std::vector<std::string>& inputs) {
  rfsmooth::cli::Console console(options.console);
  const rfsmooth::Context context = console.context({{"read", 1}});
  const auto made = rfsmooth::render::make_picture(picture_options(options, inputs), context);
  value_or_throw(rfsmooth::pipeline::io::write_bytes(made.png, *options.output, options.force, context));
  console.say(*options.output);
  if (made.colors)
    console.say(
        fmt::format("colours from {:g} (dark blue) to {:g} (yellow)", made.colors->low, made.colors->high));
}

}  // namespace

int main(int argc, char** argv) {
  return rfsmooth::cli::run_program(argc, argv, rfsmooth::cli::render_command(draw));
}
