#include "base/parallel.h"

#include <stdexcept>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "base/thread_limit.h"

namespace rfsmooth {

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

}  // namespace rfsmooth
