/// Everything a call needs that is not data: threads, progress, cancelling, log sink. There is no global
/// state; a Context is passed to every long-running function. Copyable; safe to share between calls as long
/// as its callbacks are.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <string_view>

namespace rfsmooth {

/// How much a message matters.
enum class LogLevel { debug, info, warning };

/// What a stage took.
struct StageTime {
  std::string name;
  double seconds = 0;
};

/// What every stage is given beside its data: threads and callbacks.
struct Context {
  /// Number of threads; 0 or less: all cores. The result is the same for every value.
  int threads = 0;

  /// Called on the caller's thread with the stage's name and the share done in [0, 1]; return false to
  /// cancel.
  std::function<bool(std::string_view stage, double fraction)> progress;

  /// Receives what the library has to say, as `progress` on the caller's thread and never from inside a
  /// parallel loop; nothing is printed if empty.
  std::function<void(LogLevel, const std::string&)> log;

  /// Polled by every parallel loop; set it (from a signal handler, say) to stop within a fraction of a
  /// second.
  const std::atomic<bool>* stop = nullptr;

  /// Reports progress. \throw Failure (ErrorCode::cancelled) if the caller asked to stop; caught at the front
  /// door.
  void report(std::string_view stage, double fraction) const;

  /// \throw Failure (ErrorCode::cancelled) if `stop` is set.
  void check_stop() const;

  void info(const std::string& text) const {
    if (log) log(LogLevel::info, text);
  }
  void warn(const std::string& text) const {
    if (log) log(LogLevel::warning, text);
  }
};

}  // namespace rfsmooth
