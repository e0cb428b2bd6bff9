/// What the command prints while it works: log lines, warnings and a progress bar, all on stderr. stdout is
/// for data and JSON only.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/options.h>

#include "base/thread_limit.h"
#include "pipeline/cli/console/progress.h"

namespace rfsmooth::cli {

/// Options that every working sub-command has.
struct ConsoleOptions {
  std::optional<int> threads;
  bool quiet = false;
  bool verbose = false;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"threads", "threads to use, also by libraries; auto: all cores; the result is the same",
                     "", 1, 1024},
          self.threads);
    visit(OptionInfo{"quiet", "only errors on stderr; no warnings, summary or progress", ""}, self.quiet);
    visit(OptionInfo{"verbose", "say more on stderr about what is done", ""}, self.verbose);
  }
};

/// Whether standard output is a pipe that nobody reads any more.
bool stdout_reader_is_gone();

/// Writes to standard error. What cannot be written there is lost: no work fails for it.
void to_stderr(const std::string& text);

/// The command's messages. One thread at a time.
class Console {
 public:
  /// A bar is drawn, and colours are used, only if stderr is a terminal; NO_COLOR turns colours off.
  /// With a `listener` everything goes there instead: warnings and errors as LogLevel::warning, details as
  /// debug, the rest as info.
  explicit Console(const ConsoleOptions& options,
                   std::function<void(LogLevel, const std::string&)> listener = {});
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void say(const std::string& line);     ///< a summary line; dropped by --quiet
  void detail(const std::string& line);  ///< only with --verbose
  void warn(const std::string& line);
  void error(const std::string& line);  ///< always

  /// The number of points, from which the bar shows points per second.
  void set_points(std::size_t points) { points_ = points; }

  /// The progress that the bar shows.
  Progress& progress() { return progress_; }

  /// A Context that logs to this console, reports these stages to its bar and stops on Ctrl-C. From
  /// now on ConsoleOptions::threads limits the whole process, while the console exists.
  Context context(std::vector<StageShare> stages);

 private:
  void draw(std::string_view stage, double fraction);
  void clear_bar();
  void print(const char* colour, const char* label, const std::string& line);

  std::function<void(LogLevel, const std::string&)> listener_;
  std::optional<int> threads_;  ///< none: all cores
  bool quiet_, verbose_, bar_, colour_;
  bool drawn_ = false;
  std::size_t points_ = 0;
  Progress progress_;
  std::optional<ThreadLimit> limit_;
  std::chrono::steady_clock::time_point last_draw_;
};

}  // namespace rfsmooth::cli
