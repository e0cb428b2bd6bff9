#include "pipeline/cli/options/parse.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/no_command.h"
#include "pipeline/cli/options/suggest.h"

namespace rfsmooth::cli {

namespace {

void add_help(CLI::App& app, Invocation& into) {
  app.set_help_flag();  // ours says more
  app.add_flag("-h,--help", into.short_help);
  app.add_flag("--help-all", into.long_help);
}

void add_option(CLI::App& app, const CommandOption& option, Invocation& into) {
  const auto note = [&into, name = option.name](const std::string& text) {
    into.options.emplace_back(name, text);
  };
  const std::string prefix = option.short_name ? fmt::format("-{},", option.short_name) : "";
  if (option.kind == ValueKind::flag) {
    app.add_flag_callback(prefix + "--" + option.name, [note] { note("true"); })->disable_flag_override();
    if (has_no_form(option))
      app.add_flag_callback("--no-" + option.name, [note] { note("false"); })->disable_flag_override();
  } else {
    app.add_option_function<std::string>(prefix + "--" + option.name, note);
  }
}

std::vector<std::string> option_names(const Command& command) {
  std::vector<std::string> names = {"--help", "--help-all"};
  for (const CommandOption& o : command.options) {
    names.push_back("--" + o.name);
    if (has_no_form(o)) names.push_back("--no-" + o.name);
  }
  return names;
}

std::string in_our_words(const CLI::ParseError& error) {
  std::string what = error.what();
  const std::string first = what.substr(0, what.find_first_of(" :"));
  if (what.find("flag override") != std::string::npos) return fmt::format("--{} takes no value", first);
  if (what.find("missing") != std::string::npos) return fmt::format("{} needs a value", first);
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr)
    return fmt::format("{} takes one value and may be given once", first);
  return what;
}

[[noreturn]] void refuse_unknown_option(const std::string& typed, const Command& command) {
  const std::string name = typed.substr(0, typed.find('='));
  std::error_code unknown;
  const std::string hint = std::filesystem::exists(typed, unknown)
                               ? fmt::format("; the file of that name is ./{0}, or {0} behind --", typed)
                               : did_you_mean(name, option_names(command));
  fail(ErrorCode::usage, "unknown option {} for rfsmooth {}{}", name, command.name, hint);
}

/// Whether the word behind `word` is its value.
bool takes_next(const Command& command, const std::string& word) {
  return std::any_of(command.options.begin(), command.options.end(), [&](const CommandOption& o) {
    return o.kind != ValueKind::flag &&
           (word == "--" + o.name || (o.short_name && word == std::string("-") + o.short_name));
  });
}

/// Where the options end: at the first "--" that is no option's value; argc if there is none, or no command.
int end_of_options(int argc, const char* const* argv, const std::vector<Command>& commands) {
  if (argc < 2) return argc;
  const Command* const command = find_command(commands, argv[1]);
  if (command == nullptr) return argc;
  for (int k = 2; k < argc; ++k) {
    if (std::string_view(argv[k]) == "--") return k;
    if (takes_next(*command, argv[k])) ++k;
  }
  return argc;
}

}  // namespace

Parsed parse(int argc, const char* const* argv, const std::vector<Command>& commands) {
  Parsed parsed;
  Invocation& into = parsed.invocation;
  CLI::App app;
  add_help(app, into);
  app.add_flag("--version", into.version);
  app.allow_extras();
  app.require_subcommand(0, 1);  // a file called like a command is a file

  std::vector<std::vector<std::string>> positional(commands.size());
  std::vector<CLI::App*> subs;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    CLI::App* sub = app.add_subcommand(commands[i].name);
    add_help(*sub, into);
    for (const CommandOption& option : commands[i].options) add_option(*sub, option, into);
    sub->add_option("arguments", positional[i])->type_size(1)->expected(0, 1 << 30)->allow_extra_args();
    sub->allow_extras();
    sub->fallthrough(false);
    subs.push_back(sub);
  }

  const int options_end = end_of_options(argc, argv, commands);
  try {
    app.parse(options_end, argv);
  } catch (const CLI::ParseError& error) {
    fail(ErrorCode::usage, "{}", in_our_words(error));
  }
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (!subs[i]->parsed()) continue;
    parsed.command = &commands[i];
    into.arguments = positional[i];
    for (int k = options_end + 1; k < argc; ++k) into.arguments.emplace_back(argv[k]);
    for (const std::string& extra : subs[i]->remaining())
      if (extra.size() > 1 && extra[0] == '-') refuse_unknown_option(extra, commands[i]);
  }
  const std::vector<std::string> before = app.remaining();
  if (parsed.command == nullptr && !before.empty()) refuse_words_without_command(before, commands);
  if (!before.empty())
    fail(ErrorCode::usage, "'{0}' stands before the command; write: rfsmooth {1} {0} ...", before.front(),
         parsed.command->name);
  return parsed;
}

}  // namespace rfsmooth::cli
