#include "base/parallel.h"

#include <chrono>
#include <cmath>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include <rfsmooth/result.h>

using namespace rfsmooth;

namespace {

TEST(Parallel, SumHasTheSameBitsForAnyThreadCount) {
  double first = 0;
  for (const int threads : {1, 2, 3, 4, 7}) {
    Context context;
    context.threads = threads;
    double sum = 0;
    in_arena(context, [&] {
      sum = sum_over(context, 100003, 0.0, [](std::size_t i) { return std::sin(double(i)); });
    });
    if (threads == 1) first = sum;
    EXPECT_EQ(sum, first) << threads;
  }
}

TEST(Parallel, ThreadsBindsLoopsOutsideAnArenaToo) {
  for (const int threads : {1, 2}) {
    Context context;
    context.threads = threads;
    std::mutex guard;
    std::set<std::thread::id> seen;
    for_blocks(context, 1000, 1, [&](std::size_t, std::size_t) {
      std::this_thread::sleep_for(std::chrono::microseconds(50));
      const std::lock_guard<std::mutex> lock(guard);
      seen.insert(std::this_thread::get_id());
    });
    EXPECT_LE(int(seen.size()), threads);
  }
}

TEST(Parallel, SortEqualsStdSort) {
  std::mt19937 engine(1);
  for (const std::size_t n : {0u, 1u, 1000u, 32768u, 32769u, 200000u}) {
    std::vector<std::uint32_t> v(n);
    for (auto& x : v) x = engine();
    std::vector<std::uint32_t> expected = v;
    std::sort(expected.begin(), expected.end());
    parallel_sort(Context{}, v, std::less<>());
    EXPECT_EQ(v, expected) << n;
  }
}

TEST(Parallel, StopCancelsALoop) {
  std::atomic<bool> stop{true};
  Context context;
  context.stop = &stop;
  const auto result = guarded([&] {
    for_each_index(context, 10, [](std::size_t) {});
    return Done{};
  });
  EXPECT_EQ(result.error().code, ErrorCode::cancelled);
}

}  // namespace
