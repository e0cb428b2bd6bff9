#include "base/halving.h"

#include <random>

#include <gtest/gtest.h>

using rfsmooth::Halving;

namespace {

struct Item {
  double at;
  std::size_t id;
};

/// Halves and checks: everything is there, both halves ascend by id, none of the lower one lies above one of
/// the upper by more than what counts as equal.
void check(const std::vector<double>& values, std::size_t half, double low, double extent, double equal) {
  std::vector<Item> items, to(values.size());
  for (const double v : values) items.push_back({v, items.size()});
  Halving()(items.data(), items.size(), half, low, extent, to.data(), [](const Item& i) { return i.at; });
  std::vector<char> seen(values.size(), 0);
  for (const Item& i : to) {
    EXPECT_EQ(i.at, values[i.id]);
    seen[i.id] = 1;
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), std::ptrdiff_t(values.size()));
  const auto by_id = [](const Item& a, const Item& b) { return a.id < b.id; };
  const auto middle = to.begin() + std::ptrdiff_t(half);
  EXPECT_TRUE(std::is_sorted(to.begin(), middle, by_id));
  EXPECT_TRUE(std::is_sorted(middle, to.end(), by_id));
  const auto by_value = [](const Item& a, const Item& b) { return a.at < b.at; };
  EXPECT_LE(std::max_element(to.begin(), middle, by_value)->at,
            std::min_element(middle, to.end(), by_value)->at + equal);
}

TEST(Halving, PutsTheLowerHalfFirstInOrder) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal(3, 2);
  for (const std::size_t n : {2u, 9u, 16u, 100u, 512u, 513u, 5000u}) {
    std::vector<double> values(n);
    for (double& v : values) v = normal(engine);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    for (const std::size_t half : {std::size_t{1}, n / 2, n - 1})
      check(values, half, *low, *high - *low, 1e-8);
    for (double& v : values) v = std::round(v);  // ties
    check(values, n / 2, -10, 30, 0);
  }
}

TEST(Halving, LosesNothingWhereTheSpanTellsNothing) {
  const std::vector<double> values = {5, 1, 4, 2, 3, 1e300, -1e300, 0};
  check(values, 4, 0, 0, 1e301);       // no extent: in the order in which they come
  check(values, 4, 100, 1, 1e301);     // all below
  check(values, 4, 0, 1e-310, 1e301);  // a share of it would be infinite
}

}  // namespace
