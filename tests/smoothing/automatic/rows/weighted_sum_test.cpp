#include "smoothing/automatic/rows/weighted_sum.h"

#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "base/raw_array.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

TEST(WeightedSums, AreThoseOfOneAfterTheOtherForAnySize) {
  std::vector<float> values(50);
  const std::vector<float> others(values.size(), 1);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i * i) - 300;
  for (std::size_t size = 0; size < 14; ++size) {
    std::vector<Index> picked;
    std::vector<std::uint8_t> small;
    std::vector<std::uint16_t> large;
    double sum = 0, weights = 0, large_sum = 0;
    for (std::size_t k = 0; k < size; ++k) {
      picked.push_back(Index(7 * k % values.size()));
      small.push_back(std::uint8_t(250 - 9 * k));
      large.push_back(std::uint16_t(65535 - 900 * k));
      sum += double(small[k]) * double(values[picked[k]]);
      large_sum += double(large[k]) * double(values[picked[k]]);
      weights += double(small[k]);
    }
    const std::array<const float*, 2> both = {others.data(), values.data()};
    const auto found = weighted_sums(size, picked.data(), small.data(), both);
    EXPECT_NEAR(double(found.sum[1]), sum, 1e-6 * 250 * 2200 * double(size));
    EXPECT_EQ(double(found.weights), weights);
    EXPECT_EQ(found.sum[0], found.weights);
    EXPECT_NEAR(double(weighted_sums(size, picked.data(), large.data(), both).sum[1]), large_sum,
                1e-6 * 65535 * 2200 * double(size));
  }
}

TEST(RawArray, KeepsWhatItHeldWhenItGrowsAndItsMemoryWhenCleared) {
  RawArray<int> array(3);
  for (int i = 0; i < 3; ++i) array[std::size_t(i)] = 10 + i;
  array.resize(1000);
  EXPECT_EQ(array.size(), 1000u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(array[std::size_t(i)], 10 + i);
  const int* const where = array.data();
  array.clear();
  EXPECT_EQ(array.size(), 0u);
  array.resize(900);
  EXPECT_EQ(array.data(), where);
}

}  // namespace
