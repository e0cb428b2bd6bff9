#include "base/parallel.h"

#include <stdexcept>

#ifdef RFSMOOTH_STD_THREADS
#include <atomic>
#include <exception>
#include <mutex>
#include <set>
#include <thread>
#else
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

#include "base/thread_limit.h"

namespace rfsmooth {

#ifdef RFSMOOTH_STD_THREADS

// The same loops over std::thread, for the thread sanitizer, which does not see how TBB's workers wait for
// each other. Every loop starts its threads anew; loops inside loops run on the thread that they are met by.
namespace {

constexpr int kLeastThreads = 4;  // by default, also on fewer cores: races are looked for here, not time

std::mutex limits_guard;
std::multiset<std::size_t> limits;  // of the ThreadLimits that live

thread_local int arena_threads = 0;  // of the arena this thread is in; 0: in none
thread_local bool inside_loop = false;

std::size_t threads_for(const Context& context) {
  if (inside_loop) return 1;
  const int all = std::max(kLeastThreads, int(std::thread::hardware_concurrency()));
  std::size_t threads = std::size_t(arena_threads > 0 ? arena_threads : all);
  if (context.threads > 0) threads = std::min(threads, std::size_t(context.threads));
  const std::lock_guard<std::mutex> lock(limits_guard);
  return limits.empty() ? threads : std::min(threads, *limits.begin());
}

}  // namespace

struct ThreadLimit::Control {
  explicit Control(std::size_t most) {
    const std::lock_guard<std::mutex> lock(limits_guard);
    at = limits.insert(most);
  }
  ~Control() {
    const std::lock_guard<std::mutex> lock(limits_guard);
    limits.erase(at);
  }
  std::multiset<std::size_t>::iterator at;
};

ThreadLimit::ThreadLimit(int threads) {
  if (threads < 1) throw std::invalid_argument("ThreadLimit: at least one thread is needed");
  control_ = std::make_unique<Control>(std::size_t(threads));
}

ThreadLimit::~ThreadLimit() = default;

void in_arena(const Context& context, const std::function<void()>& body) {
  struct Restore {
    int before = arena_threads;
    ~Restore() { arena_threads = before; }
  } restore;
  arena_threads = context.threads;
  body();
}

void for_blocks(const Context& context, std::size_t n, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)>& body) {
  const std::size_t blocks = (n + grain - 1) / grain;
  const std::size_t threads = std::min(threads_for(context), blocks);
  // Every thread has a block of its own to begin with, so that short loops have several threads, too.
  std::atomic<std::size_t> next{threads};
  std::exception_ptr failure;
  std::mutex failure_guard;
  const auto work = [&](std::size_t first) {
    const bool before = inside_loop;
    inside_loop = before || threads > 1;
    try {
      for (std::size_t block = first; block < blocks; block = next++) {
        context.check_stop();
        body(block * grain, std::min(n, (block + 1) * grain));
      }
    } catch (...) {
      next = blocks;  // the others end after their block
      const std::lock_guard<std::mutex> lock(failure_guard);
      if (!failure) failure = std::current_exception();
    }
    inside_loop = before;
  };
  std::vector<std::thread> others;
  for (std::size_t t = 1; t < threads; ++t) others.emplace_back(work, t);
  work(0);
  for (std::thread& thread : others) thread.join();
  if (failure) std::rethrow_exception(failure);
}

#else

struct ThreadLimit::Control {
  explicit Control(std::size_t most) : limit(tbb::global_control::max_allowed_parallelism, most) {}
  tbb::global_control limit;
};

ThreadLimit::ThreadLimit(int threads) {
  if (threads < 1) throw std::invalid_argument("ThreadLimit: at least one thread is needed");
  const auto most = std::size_t(std::min(threads, tbb::info::default_concurrency()));
  control_ = std::make_unique<Control>(most);
}

ThreadLimit::~ThreadLimit() = default;

void in_arena(const Context& context, const std::function<void()>& body) {
  // More threads than cores gain nothing, and TBB would print a warning.
  const int threads = std::min(context.threads, tbb::info::default_concurrency());
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute(body);
}

void for_blocks(const Context& context, std::size_t n, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)>& body) {
  const std::size_t blocks = (n + grain - 1) / grain;
  const auto run = [&](std::size_t block) {
    context.check_stop();
    body(block * grain, std::min(n, (block + 1) * grain));
  };
  if (blocks == 1) return run(0);
  // Outside in_arena (reading and writing files, say) the caller's number of threads holds too.
  if (context.threads > 0 && context.threads < tbb::this_task_arena::max_concurrency())
    return in_arena(context, [&] { for_blocks(context, n, grain, body); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1),
                    [&](const tbb::blocked_range<std::size_t>& r) {
                      for (std::size_t block = r.begin(); block != r.end(); ++block) run(block);
                    });
}

#endif

}  // namespace rfsmooth
