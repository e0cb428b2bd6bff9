#include "rfsmooth/rfs_mesh/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace rfsmooth {

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
