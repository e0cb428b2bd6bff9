/// Times the stages of a computation.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <rfsmooth/context.h>

namespace rfsmooth {

/// The entry of a stage, which is made if there is none.
inline std::size_t entry_of(std::string_view name, std::vector<StageTime>& stages) {
  std::size_t entry = 0;
  while (entry < stages.size() && stages[entry].name != name) ++entry;
  if (entry == stages.size()) stages.push_back({std::string(name), 0});
  return entry;
}

/// Adds times to the entries of the same stages.
inline void add_times(const std::vector<StageTime>& more, std::vector<StageTime>& stages) {
  for (const StageTime& stage : more) stages[entry_of(stage.name, stages)].seconds += stage.seconds;
}

/// Adds the time from its construction to its destruction to the entry of a stage. Not thread safe.
class Stopwatch {
 public:
  /// \param stages kept by reference. It must outlive this; a copy made before the destruction lacks the last
  /// time.
  Stopwatch(std::vector<StageTime>& stages, std::string_view name) : stages_(stages) { start(name); }
  ~Stopwatch() { stop(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

  /// Ends the present stage and begins the next one.
  void next(std::string_view name) {
    stop();
    start(name);
  }

 private:
  using Clock = std::chrono::steady_clock;

  // The entry is made here: a destructor must not allocate.
  void start(std::string_view name) {
    entry_ = entry_of(name, stages_);
    start_ = Clock::now();
  }
  void stop() { stages_[entry_].seconds += std::chrono::duration<double>(Clock::now() - start_).count(); }

  std::vector<StageTime>& stages_;
  std::size_t entry_ = 0;
  Clock::time_point start_;
};

}  // namespace rfsmooth
