#include "pipeline/adapters/python/option_tables.h"

#include <array>
#include <map>
#include <set>
#include <stdexcept>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <rfsmooth/flow.h>

#include "pipeline/cli/files/cloud_jobs.h"

namespace rfsmooth::python {

namespace nb = nanobind;

namespace {

using Defaults = std::map<std::string, std::set<std::optional<std::string>>>;

/// What every flow that has an option, or every modifier, starts it with.
Defaults defaults_of_flows() {
  Defaults defaults;
  const auto enter = [&](auto& fields) {
    for (const cli::CommandOption& o : cli::collect(fields)) defaults[o.name].insert(o.get());
  };
  for (AnyFlow flow : rfsmooth::flows()) std::visit(enter, flow);
  Modifiers modifiers;
  enter(modifiers);
  return defaults;
}

std::set<std::string> names_for_files() {
  cli::JobOptions job;
  std::set<std::string> names;
  for (const cli::CommandOption& o : cli::collect(job)) names.insert(o.name);
  return names;
}

/// Whether an option names a file that is written beside the result: one that is read says what is done.
bool is_written(const cli::CommandOption& option) {
  return option.kind == cli::ValueKind::file && option.name != "statistics";
}

const char* name_of(cli::ValueKind kind) {
  constexpr std::array kNames = {"flag", "integer", "number", "word", "length", "file"};
  return kNames.at(std::size_t(kind));
}

}  // namespace

cli::Command command_of(const std::string& name) {
  const std::vector<cli::Command> commands = cli::all_commands();
  if (const cli::Command* const command = cli::find_command(commands, name)) return *command;
  throw std::invalid_argument("there is no sub-command " + name);
}

void assign_all(const cli::Command& command, const OptionTexts& options) {
  for (const auto& [name, text] : options) {
    const cli::CommandOption* const option = cli::find_option(command.options, name);
    if (option == nullptr) throw std::invalid_argument("there is no option " + name);
    cli::assign(*option, text);
  }
  for (const cli::CommandOption& option : command.options)
    if (option.finish) option.finish();
  cli::Invocation typed;
  typed.options = options;
  if (command.on_cloud.check) command.on_cloud.check(typed);
}

nb::list option_table(const std::string& name) {
  const std::set<std::string> elsewhere = names_for_files();
  const Defaults of_flows = defaults_of_flows();
  nb::list table;
  for (const cli::CommandOption& o : command_of(name).options) {
    if (elsewhere.count(o.name) > 0 || is_written(o)) continue;
    nb::dict entry;
    entry["name"] = o.name;
    entry["kind"] = name_of(o.kind);
    entry["optional"] = o.optional;
    entry["choices"] = o.choices;
    entry["help"] = o.help;
    entry["unit"] = o.unit;
    entry["range"] = o.range;
    std::optional<std::string> value = o.get();
    if (const auto flows = of_flows.find(o.name); flows != of_flows.end() && o.optional)
      value = flows->second.size() == 1 ? *flows->second.begin() : std::nullopt;
    entry["default"] = value;
    table.append(entry);
  }
  return table;
}

}  // namespace rfsmooth::python
