/// A limit for the whole program. Limits may be made and ended by any thread.
#pragma once

#include <memory>

namespace rfsmooth {

/// While it lives, the process runs at most `threads` threads in parallel loops: ours, and those of libraries
/// that use TBB. For programs; a library leaves the choice to its caller (Context::threads). Several may
/// live: the least counts.
class ThreadLimit {
 public:
  /// `threads`: at least 1. More than there are cores are no limit.
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

}  // namespace rfsmooth
