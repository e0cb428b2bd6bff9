/// How long the stages of some work took.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <rfsmooth/context.h>

namespace rfsmooth {

/// Adds the time it lives to a stage's entry, which it makes if there is none. Not thread safe.
class Stopwatch {
 public:
  /// \param stages is kept by reference: it must stay where it is, and not be returned, while this lives.
  Stopwatch(std::vector<StageTime>& stages, std::string_view name) : stages_(stages) { start(name); }
  ~Stopwatch() { stop(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

  /// This stage ends here and the next one begins.
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

}  // namespace rfsmooth
