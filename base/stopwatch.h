/// Times the stages of a computation.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <rfsmooth/context.h>

namespace rfsmooth {

/// Adds the time from its construction to its destruction to the entry of a stage, which it creates if need
/// be. Not thread safe.
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
    entry_ = 0;
    while (entry_ < stages_.size() && stages_[entry_].name != name) ++entry_;
    if (entry_ == stages_.size()) stages_.push_back({std::string(name), 0});
    start_ = Clock::now();
  }
  void stop() { stages_[entry_].seconds += std::chrono::duration<double>(Clock::now() - start_).count(); }

  std::vector<StageTime>& stages_;
  std::size_t entry_ = 0;
  Clock::time_point start_;
};

/// Adds times to the entries of the same stages, which it creates if need be.
inline void add_times(const std::vector<StageTime>& more, std::vector<StageTime>& stages) {
  for (const StageTime& stage : more) {
    std::size_t entry = 0;
    while (entry < stages.size() && stages[entry].name != stage.name) ++entry;
    if (entry == stages.size()) stages.push_back({stage.name, 0});
    stages[entry].seconds += stage.seconds;
  }
}

}  // namespace rfsmooth
