/// What the small programs of this folder share: an options table (rfsmooth/options.h) bound to CLI11, and
/// the end of main.
#pragma once

#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <rfsmooth/options.h>
#include <rfsmooth/result.h>

namespace rfsmooth::clouds {

class Binder {
 public:
  explicit Binder(CLI::App& app) : app_(app) {}

  void operator()(const OptionInfo& info, bool& field) { app_.add_flag(dashed(info), field, help(info)); }
  template <class T>
  void operator()(const OptionInfo& info, T& field) {
    CLI::Option* const option = app_.add_option(dashed(info), field, help(info))->capture_default_str();
    if (info.choices.empty()) return;
    const std::vector<std::string> words(info.choices.begin(), info.choices.end());
    option->check(CLI::IsMember(words).description(""));  // which the help has
  }

 private:
  static std::string dashed(const OptionInfo& info) { return "--" + std::string(info.name); }
  static std::string help(const OptionInfo& info) {
    std::string text(info.help);
    if (!info.unit.empty()) text += " (" + std::string(info.unit) + ")";
    for (const std::string_view choice : info.choices)
      text += (choice == info.choices.front() ? ": " : " | ") + std::string(choice);
    return text;
  }
  CLI::App& app_;
};

/// Ranges are checked by `validate`, so that the program and the library say the same; words here, for
/// `validate` does not know them.
template <class Options>
void bind(CLI::App& app, Options& options) {
  Options::describe(options, Binder(app));
}

constexpr int kWrongUsage = 2;  ///< exit code; 1 for all else that fails

/// Reads the arguments. \return the exit code if the program ends here: help was asked for, or a wrong
/// argument told.
inline std::optional<int> parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return {};
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kWrongUsage;
  }
}

/// The exit code of run(argc, argv), or of what it throws, which is told on standard error after the
/// program's name.
inline int tell_failures(const char* name, int (*run)(int, char**), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const Failure& failure) {
    std::fprintf(stderr, "%s: %s\n", name, failure.what());
    return failure.error.code == ErrorCode::usage ? kWrongUsage : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace rfsmooth::clouds
