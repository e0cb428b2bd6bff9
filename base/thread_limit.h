/// A limit on the threads of the whole process. Limits may be made and destroyed by any thread.
#pragma once

#include <memory>

namespace rfsmooth {

/// While an object exists, parallel loops of this process use at most `threads` threads: ours and those of
/// other libraries that use TBB. Of several limits the lowest counts. For programs; a library leaves the
/// choice to its caller (Context::threads).
class ThreadLimit {
 public:
  /// `threads`: at least 1. A number above that of the cores has no effect.
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

}  // namespace rfsmooth
