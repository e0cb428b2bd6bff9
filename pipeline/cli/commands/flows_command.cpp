/// rfsmooth flows: every way of smoothing, from the library's registry.
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rfsmooth/flow.h>

#include "base/fail.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/options/json_values.h"
#include "pipeline/io/json_file.h"

namespace rfsmooth::cli {

namespace {

struct FlowsOptions {
  bool json = false;
  bool markdown = false;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"json", "print JSON", ""}, self.json);
    visit(OptionInfo{"markdown", "print the table of docs/FLOWS.md", ""}, self.markdown);
  }
};

/// The flow's own options, with its values. They point into `flow`.
std::vector<CommandOption> options_of(AnyFlow& flow) {
  return std::visit([](auto& values) { return collect(values); }, flow);
}

/// The option with the flow's value, as it can be typed; of a flag what there is to type, in brackets.
std::string typed_default(const CommandOption& option) {
  if (option.kind == ValueKind::flag) return fmt::format("[{}]", fmt::join(typed_names(option), "|"));
  return fmt::format("--{} {}", option.name, option.get().value_or("auto"));
}

void print_table() {
  for (AnyFlow flow : rfsmooth::flows()) {
    const FlowInfo& info = info_of(flow);
    fmt::print("{:<18} {} ({})\n{:18}", info.name, info.summary, info.source, "");
    for (const CommandOption& option : options_of(flow)) fmt::print(" {}", typed_default(option));
    fmt::print("\n");
  }
}

void print_markdown() {
  fmt::print("| flow | what it does | source |\n|---|---|---|\n");
  for (const AnyFlow& flow : rfsmooth::flows()) {
    const FlowInfo& info = info_of(flow);
    fmt::print("| `{}` | {} | {} |\n", info.name, info.summary, info.source);
  }
}

void print_json() {
  auto list = nlohmann::ordered_json::array();
  for (AnyFlow flow : rfsmooth::flows()) {
    const FlowInfo& info = info_of(flow);
    auto defaults = nlohmann::ordered_json::object();
    for (const CommandOption& option : options_of(flow))
      defaults[option.name] = json_value(option.get().value_or("auto"));
    list.push_back(
        {{"name", info.name}, {"summary", info.summary}, {"source", info.source}, {"options", defaults}});
  }
  fmt::print("{}", pipeline::io::in_lines(list));
}

}  // namespace

Command flows_command() {
  auto options = std::make_shared<FlowsOptions>();
  Command command;
  command.name = "flows";
  command.summary = "list the ways of smoothing that --flow takes";
  command.usage = {"[--json|--markdown]"};
  command.description =
      "Prints every flow with its source and the options it uses, each with its value there; flags are in "
      "brackets.";
  command.options = collect(*options);
  command.run = [options](const Invocation& typed) {
    if (!typed.arguments.empty()) fail(ErrorCode::usage, "rfsmooth flows takes no arguments");
    if (options->json && options->markdown)
      fail(ErrorCode::usage, "--json and --markdown exclude each other");
    options->json ? print_json() : options->markdown ? print_markdown() : print_table();
    return 0;
  };
  return command;
}

}  // namespace rfsmooth::cli
