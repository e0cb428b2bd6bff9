/// A run in a process of its own, so that time and peak memory are the run's alone.
#pragma once

#include <functional>
#include <string>

namespace rfsmooth::bench {

struct Cost {
  double seconds = 0;  ///< wall
  double cpu = 0;      ///< seconds, all threads
  double bytes = 0;    ///< peak of resident memory above what was resident before
};

struct Apart {
  Cost cost;
  std::string said;  ///< what the job returned
};

/// Measures `work` when called; handed to the job, which may prepare and judge outside of it.
using Measure = std::function<void(const std::function<void()>& work)>;

/// Forks, runs the job in the child and brings back what it cost and said. Call it from a process that has
/// never started a thread: threads do not survive a fork. \throw std::logic_error if it has some;
/// std::runtime_error if the child does not end well (what it threw is on standard error).
Apart run_apart(const std::function<std::string(const Measure&)>& job);

}  // namespace rfsmooth::bench
