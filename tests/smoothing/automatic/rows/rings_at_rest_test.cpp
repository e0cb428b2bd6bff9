#include "smoothing/automatic/rows/rings_at_rest.h"

#include <random>

#include <gtest/gtest.h>

namespace rfsmooth::smoothing {
namespace {

TEST(RingsAtRest, WakeAsTheyWere) {
  std::mt19937 random(1);
  for (const std::size_t n : {1U, 100U, 100'000U}) {
    Adjacency rings;
    rings.start.push_back(0);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < i % 9; ++k)
        rings.items.push_back(i / 1000 % 2 == 0 ? Index((i + k) % n) : Index(random() % n));
      rings.start.push_back(Index(rings.items.size()));
    }
    const Adjacency woken = RingsAtRest(rings, {}).wake({});
    EXPECT_EQ(woken.start, rings.start);
    EXPECT_EQ(woken.items, rings.items);
  }
}

}  // namespace
}  // namespace rfsmooth::smoothing
