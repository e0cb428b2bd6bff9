/// rfsmooth flows: every way of smoothing, from the library's registry.
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "rfsmooth/pipeline/cli/command.h"
#include "rfsmooth/smoothing/flow.h"

namespace rfsmooth::cli {

namespace {

struct FlowsOptions {
  bool json = false;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"json", "print JSON", ""}, self.json);
  }
};

void print_table() {
  for (const smoothing::FlowEntry& flow : smoothing::flows()) {
    fmt::print("{:<16} {}\n{:16} {}; options: --iterations ({})", flow.name, flow.summary, "", flow.source,
               flow.default_iterations);
    for (const auto parameter : flow.parameters)
      if (parameter != "iterations") fmt::print(", --{}", parameter);
    fmt::print("\n");
  }
}

void print_json() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const smoothing::FlowEntry& flow : smoothing::flows())
    list.push_back({{"name", flow.name},
                    {"summary", flow.summary},
                    {"source", flow.source},
                    {"parameters", flow.parameters},
                    {"default_iterations", flow.default_iterations}});
  fmt::print("{}\n", list.dump(2));
}

}  // namespace

Command flows_command() {
  auto options = std::make_shared<FlowsOptions>();
  Command command;
  command.name = "flows";
  command.summary = "list the ways of smoothing that --flow takes";
  command.usage = {"[--json]"};
  command.description = "Prints every flow with its source and the options it uses.";
  collect(*options, command.options);
  command.run = [options](const Invocation& typed) {
    if (!typed.arguments.empty()) throw Failure({ErrorCode::usage, "rfsmooth flows takes no arguments"});
    options->json ? print_json() : print_table();
    return 0;
  };
  return command;
}

}  // namespace rfsmooth::cli
