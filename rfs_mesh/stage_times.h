/// How long the stages of some work took.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace rfsmooth {

/// What a stage took.
struct StageTime {
  std::string name;
  double seconds = 0;
};

/// Times stages that follow one another. Not thread safe.
class Laps {
 public:
  explicit Laps(std::vector<StageTime>& stages) : stages_(stages) {}

  /// Appends the stage that ends here: the time since the last one ended, or since this was made.
  void lap(std::string name) {
    const auto now = std::chrono::steady_clock::now();
    stages_.push_back({std::move(name), std::chrono::duration<double>(now - start_).count()});
    start_ = now;
  }

 private:
  std::vector<StageTime>& stages_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace rfsmooth
