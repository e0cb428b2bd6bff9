#include "pipeline/tiles/allowed.h"

#include <string_view>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/io/io.h"

namespace rfsmooth::pipeline::tiles {

namespace {

/// The flows that clouds are smoothed by in tiles.
std::vector<std::string_view> flows_in_tiles() {
  std::vector<std::string_view> names;
  for (const AnyFlow& flow : flows())
    if (std::holds_alternative<AutomaticOptions>(flow) || support_rings({flow}))
      names.push_back(name_of(flow));
  return names;
}

}  // namespace

void check_for_tiles(const DenoiseOptions& options) {
  const FlowOptions& flow = options.flow;
  const auto* automatic = std::get_if<AutomaticOptions>(&flow.flow);
  if (automatic != nullptr && automatic->iterations != 1)
    fail(ErrorCode::usage, "in tiles the automatic flow takes one iteration");
  if (automatic != nullptr && flow.modifiers.any())
    fail(ErrorCode::usage, "in tiles the automatic flow goes without modifiers");
  if (automatic == nullptr && !support_rings(flow))
    fail(ErrorCode::usage,
         "any point of the cloud may have a say in where the flow '{}' moves another with these options, so "
         "they do not go in tiles; {} do, all vertices at once and without modifiers but `push-back`",
         name_of(flow.flow), fmt::join(flows_in_tiles(), ", "));
}

void check_format(io::Format input, const std::string& output) {
  if (const auto format = io::format_of_extension(output).value_or(input); format != input)
    fail(ErrorCode::usage, "{}: in tiles a cloud keeps its format, {}", output, io::name_of(input));
}

}  // namespace rfsmooth::pipeline::tiles
