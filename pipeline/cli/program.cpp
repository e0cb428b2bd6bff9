#include "pipeline/cli/program.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include <fmt/format.h>

#include <rfsmooth/version.h>

#include "base/fail.h"
#include "pipeline/cli/console/console.h"
#include "pipeline/cli/console/stop.h"
#include "pipeline/cli/exit_code.h"
#include "pipeline/cli/options/config.h"
#include "pipeline/cli/options/help.h"
#include "pipeline/cli/options/parse.h"
#include "pipeline/cli/options/text_values.h"

namespace rfsmooth::cli {

namespace {

/// stdout is checked when it is closed: a full disk or a closed pipe must not end in exit code 0. Nothing is
/// said to a reader that has seen enough, as head has.
int close_stdout(int code) {
  const bool failed = std::ferror(stdout) != 0, gone = stdout_reader_is_gone();
  if ((std::fclose(stdout) == 0 && !failed) || code != 0) return code;
  if (!gone) Console({}).error("cannot write to standard output");
  return exit_code(ErrorCode::cannot_write);
}

/// What shows more of the sub-command that was typed, or of all.
std::string help_line(int argc, const char* const* argv, const std::vector<Command>& commands) {
  const Command* const command = argc > 1 ? find_command(commands, argv[1]) : nullptr;
  return fmt::format("see: rfsmooth {}--help\n", command == nullptr ? "" : command->name + ' ');
}

/// The words with `help` as `--help` and `help COMMAND` as `COMMAND --help`.
std::vector<const char*> with_help_as_option(int argc, const char* const* argv) {
  std::vector<const char*> words(argv, argv + argc);
  if (argc < 2 || std::string_view(argv[1]) != "help") return words;
  words.erase(words.begin() + 1);
  words.insert(words.begin() + std::min(argc - 1, 2), "--help");
  return words;
}

int print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  return 0;
}

/// Refuses names of files that a report could not tell: their letters are not UTF-8, as JSON needs them.
void need_whole_names(const std::string& report, const Config& config) {
  constexpr std::string_view kReplaced = "\xef\xbf\xbd";  // what JSON has in the place of such a letter
  std::vector<std::string> names = config.arguments;
  if (config.folder) names.push_back(*config.folder);
  for (const std::string& name : names)
    if (name.find(kReplaced) != std::string::npos)
      fail(ErrorCode::usage,
           "{}: cannot tell the name of {}, which is not UTF-8; name the files beside --config", report,
           name);
}

/// Assigns the options: those of --config first, then what was typed. The files come from the config if none
/// were typed.
Invocation with_config(const Command& command, Invocation typed) {
  const auto assign_all = [&](const auto& values) {
    for (const auto& [name, text] : values) assign(*find_option(command.options, name), text);
  };
  bool output_typed = false;
  for (const auto& [name, text] : typed.options) {
    output_typed = output_typed || name == "output";
    if (name != "config") continue;
    Config config = read_config(text, command);
    assign_all(config.options);
    if (!typed.arguments.empty() || output_typed) continue;
    need_whole_names(text, config);
    typed.arguments = std::move(config.arguments);
    if (config.folder) assign_all(std::vector{std::pair("output", *config.folder)});
  }
  assign_all(typed.options);
  for (const CommandOption& option : command.options)
    if (option.finish) option.finish();
  return typed;
}

int run(int argc, const char* const* argv, const std::vector<Command>& commands) {
  const std::vector<const char*> words = with_help_as_option(argc, argv);
  const Parsed parsed = parse(int(words.size()), words.data(), commands);
  const Invocation& typed = parsed.invocation;
  if (parsed.command == nullptr) {
    if (typed.version) return print(std::string("rfsmooth ") + kVersion + "\n");
    if (typed.short_help || typed.long_help) return print(overview(commands, typed.long_help));
    to_stderr(overview(commands, false));
    return exit_code(ErrorCode::usage);
  }
  const Command& command = *parsed.command;
  if (typed.short_help || typed.long_help) return print(help_of(command, typed.long_help));
  const int code = command.run(with_config(command, typed));
  if (code == exit_code(ErrorCode::usage)) to_stderr(help_line(argc, argv, commands));
  return code;
}

}  // namespace

int run_program(int argc, const char* const* argv, const std::vector<Command>& commands) {
  int code = exit_code(ErrorCode::internal);
  try {
    catch_signals();
    code = run(argc, argv, commands);
  } catch (const Failure& failure) {
    code = exit_code(failure.error.code);
    Console({}).error(with_dashes(failure.error.message));
    if (failure.error.code == ErrorCode::usage) to_stderr(help_line(argc, argv, commands));
  } catch (const std::bad_alloc&) {
    code = exit_code(ErrorCode::out_of_memory);
    Console({}).error("not enough memory");
  } catch (const std::exception& bug) {
    if (std::ferror(stdout) != 0)  // fmt::print throws
      code = 0;                    // said below
    else
      Console({}).error(fmt::format("internal error, please report it: {}", bug.what()));
  }
  return close_stdout(code);
}

int run_program(int argc, const char* const* argv, const Command& command) {
  std::vector<const char*> words(argv, argv + argc);
  const bool version = argc == 2 && std::string_view(argv[1]) == "--version";
  if (words.empty()) words.push_back("rfsmooth");  // a caller may leave out even the name of the program
  if (!version) words.insert(words.begin() + 1, command.name.c_str());
  return run_program(int(words.size()), words.data(), std::vector<Command>{command});
}

}  // namespace rfsmooth::cli
