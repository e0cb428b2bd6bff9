/// Binds an options table (rfs_mesh/options.h) to CLI11, for the small programs of this folder.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "rfsmooth/rfs_mesh/options.h"

namespace rfsmooth::clouds {

class Binder {
 public:
  explicit Binder(CLI::App& app) : app_(app) {}

  void operator()(const OptionInfo& info, bool& field) { app_.add_flag(dashed(info), field, help(info)); }
  template <class T>
  void operator()(const OptionInfo& info, T& field) {
    app_.add_option(dashed(info), field, help(info))->capture_default_str();
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

/// Ranges and choices are checked by `validate`, so that the program and the library say the same.
template <class Options>
void bind(CLI::App& app, Options& options) {
  Options::describe(options, Binder(app));
}

}  // namespace rfsmooth::clouds
