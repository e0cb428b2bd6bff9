#include "base/quantile.h"

#include <random>

#include <gtest/gtest.h>

using rfsmooth::median;

namespace {

TEST(Median, HasHalfOfTheOthersOnEachSide) {
  std::mt19937_64 engine(1);
  std::uniform_int_distribution<int> tied(0, 9);
  for (std::size_t n = 1; n <= 64; ++n) {
    std::vector<double> values(n);
    for (double& v : values) v = tied(engine);
    std::vector<double> shuffled = values;
    const double found = median(shuffled);
    std::sort(values.begin(), values.end());
    EXPECT_EQ(found, values[n / 2]) << n;
    EXPECT_TRUE(std::is_permutation(values.begin(), values.end(), shuffled.begin()));
  }
}

TEST(Quantile, HasItsShareOfTheOthersBelowIt) {
  std::mt19937_64 engine(3);
  std::uniform_int_distribution<int> tied(0, 9);
  for (std::size_t n = 1; n <= 64; ++n) {
    std::vector<double> values(n);
    for (double& v : values) v = tied(engine);
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      EXPECT_EQ(rfsmooth::quantile(values, share), sorted[std::size_t(share * double(n - 1))]) << n;
      EXPECT_TRUE(std::is_permutation(sorted.begin(), sorted.end(), values.begin()));
    }
  }
}

TEST(NthOfFew, IsWhatSortingPutsThere) {
  std::mt19937_64 engine(2);
  std::uniform_int_distribution<int> tied(0, 9);
  for (std::size_t n = 1; n <= 64; ++n) {
    std::array<float, 64> values = {};
    for (std::size_t i = 0; i < n; ++i) values[i] = float(tied(engine));
    std::array<float, 64> sorted = values;
    std::sort(sorted.begin(), sorted.begin() + std::ptrdiff_t(n));
    for (const std::size_t nth : {std::size_t{0}, n / 2, n * 9 / 10, n - 1}) {
      std::array<float, 64> copy = values;
      EXPECT_EQ(rfsmooth::nth_of_few(copy, n, nth), sorted[nth]) << n;
    }
  }
}

TEST(Median, IsOfTheGivenPartOnly) {
  std::vector<double> values = {1, 7, 3, 100, -100};
  EXPECT_EQ(median(values.begin(), values.begin() + 3), 3);
  EXPECT_EQ(values[3], 100);
  EXPECT_EQ(values[4], -100);
}

TEST(Quantile, OfMembersIsThatOfTheirValues) {
  struct Sized {
    double size;
  };
  const std::vector<Sized> items = {{4}, {1}, {3}, {2}, {5}};
  EXPECT_EQ(rfsmooth::quantile_of(items, 0.25, &Sized::size), 2);
  EXPECT_EQ(rfsmooth::quantile_of(items, 0, [](const Sized& item) { return -item.size; }), -5);
}

TEST(Median, OfTwoIsTheUpperAndOfNoneZero) {
  std::vector<double> two = {5, 2}, none;
  EXPECT_EQ(median(two), 5);
  EXPECT_EQ(median(none), 0);
}

}  // namespace
