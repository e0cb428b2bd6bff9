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

TEST(Parallel, SumOfSeveralThreadsHasTheBitsOfOne) {
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

TEST(Parallel, TheFirstIsKeptWhateverTheOrder) {
  std::atomic<std::uint32_t> least{1u << 31}, most{0};
  for_each_index(
      Context{}, 100000,
      [&](std::size_t i) {
        const auto value = std::uint32_t(1 + i * 7919 % 100003);
        keep_first(least, value, std::less<>());
        keep_first(most, value, std::greater<>());
      },
      16);
  std::uint32_t low = 1u << 31, high = 0;
  for (std::size_t i = 0; i < 100000; ++i) {
    low = std::min(low, std::uint32_t(1 + i * 7919 % 100003));
    high = std::max(high, std::uint32_t(1 + i * 7919 % 100003));
  }
  EXPECT_EQ(least, low);
  EXPECT_EQ(most, high);
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
