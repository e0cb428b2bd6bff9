/// An option of the command, as text. Every option of every sub-command comes from a `describe` table
/// (rfsmooth/options.h). Parsing, --help, man pages, completion, --config and the JSON report all use this
/// form.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <rfsmooth/flow_options.h>
#include <rfsmooth/options.h>

namespace rfsmooth::cli {

enum class ValueKind { flag, integer, number, word, length, file };

struct CommandOption {
  std::string name;     ///< long name without the dashes
  char short_name = 0;  ///< 0 = none
  std::string help, unit;
  ValueKind kind = ValueKind::flag;
  bool optional = false;       ///< takes the word "auto" (files: may be left out)
  bool on_by_default = false;  ///< a flag written --no-NAME to turn it off
  std::string default_text;    ///< as it would be typed
  std::string range;           ///< "0 to 1", "at least 0", ""
  std::vector<std::string> choices;

  /// Parses `text` strictly and stores it; call `assign` instead.
  std::function<void(const CommandOption& option, const std::string& text)> set;
  /// The value as it would be typed; nothing if it is auto or left out.
  std::function<std::optional<std::string>()> get;
  /// If set, to be called once every option has its value. \throw Failure (usage).
  std::function<void()> finish;
};

/// Parses `text` strictly and stores it. \throw Failure (usage) naming the option, the text and the legal
/// values.
void assign(const CommandOption& option, const std::string& text);

/// The word that stands for the value in help: NUMBER, LENGTH, FILE, ...
std::string value_name(const CommandOption& option);

/// Whether --no-NAME is accepted: for flags that are on by default or auto.
bool has_no_form(const CommandOption& option);

/// The option's name as typed: "--alpha"; "--no-swap" for a flag that is on by default; both forms for a flag
/// that is auto.
std::vector<std::string> typed_names(const CommandOption& option);

/// A visitor of `describe` tables. It appends their options, bound to the fields visited. The strings in the
/// table must be literals.
class OptionCollector {
 public:
  explicit OptionCollector(std::vector<CommandOption>& out) : out_(out) {}
  template <class T>
  void operator()(const OptionInfo& info, T& field) {
    if constexpr (std::is_enum_v<T>)
      add_words(
          info, [&field] { return std::size_t(field); }, [&field](std::size_t k) { field = T(k); });
    else
      add(info, field);
  }
  /// --flow, and the options of every flow and modifier; all default to auto, the flow's own default.
  void operator()(FlowOptions& field);

 private:
  template <class T>
  void add(const OptionInfo& info, T& field);
  template <class T>
  void add(const OptionInfo& info, std::optional<T>& field);
  void add_words(const OptionInfo& info, const std::function<std::size_t()>& get,
                 const std::function<void(std::size_t)>& set);

  std::vector<CommandOption>& out_;
};

/// The options of all `fields`, which must outlive them.
template <class... Options>
std::vector<CommandOption> collect(Options&... fields) {
  std::vector<CommandOption> out;
  (Options::describe(fields, OptionCollector(out)), ...);
  return out;
}

/// The option called `name`; null if there is none.
const CommandOption* find_option(const std::vector<CommandOption>& options, const std::string& name);

}  // namespace rfsmooth::cli
