#include "rfs_mesh/search/thinning.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "rfs_mesh/search/neighbors.h"
#include "tests/support/awkward_clouds.h"

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

TEST(Thinning, OfASubsetIsTheSameWhereverTheNearestComeFrom) {
  const Positions points = test::noisy_sphere(3000, 0.01, 2);
  std::vector<Index> all(points.size());
  std::iota(all.begin(), all.end(), Index{0});
  const std::vector<Index> kept = thin(points, all, {});
  // By the neighbours of all: the same, first of all points, then of what was kept.
  const SpatialIndex index(points, {});
  const NeighborTable near = index.nearest(3, {}), wide = index.nearest(32, {});
  EXPECT_EQ(thin_all(points, near, {}), kept);
  const auto dense = [&](const NeighborTable& of) {
    const auto copy_row = [&of](Index i, Index* row) { std::copy(of[i].begin(), of[i].end(), row); };
    return thin_dense(index, std::size_t(of.k), copy_row, kept, {});
  };
  EXPECT_EQ(dense(wide), thin(points, kept, {}));
  EXPECT_EQ(dense(near), thin(points, kept, {})) << "too few in the rows";
  EXPECT_TRUE(thin(points, {}, {}).empty());
  EXPECT_EQ(thin(points, {4}, {}), std::vector<Index>{4});
}

/// No two that are kept are among the first k of each other, and every other one has a kept one there.
void expect_independent_and_maximal(const std::vector<Index>& kept, const NeighborTable& near,
                                    std::size_t k) {
  const std::size_t n = near.size();
  const std::set<Index> in(kept.begin(), kept.end());
  std::vector<char> reached(n);
  for (std::size_t i = 0; i < n; ++i)
    for (const Index* j = near[i].begin(); j < near[i].begin() + k; ++j) {
      EXPECT_FALSE(in.count(Index(i)) == 1 && in.count(*j) == 1) << i;
      reached[i] = char(reached[i] | int(in.count(*j) == 1));
      reached[*j] = char(reached[*j] | int(in.count(Index(i)) == 1));
    }
  for (std::size_t i = 0; i < n; ++i) EXPECT_NE(reached[i] != 0, in.count(Index(i)) == 1) << i;
}

// Points at equal distances tie, and by their order one of a row would be settled in each round.
TEST(Thinning, OfRegularPointsTakesFewRounds) {
  constexpr int kSide = 512;
  Positions line, grid;
  for (int i = 0; i < kSide * kSide; ++i) {
    line.emplace_back(i, 0, 0);
    grid.emplace_back(i % kSide, i / kSide, 0);
  }
  for (const Positions& points : {line, grid}) {
    const NeighborTable near = SpatialIndex(points, {}).nearest(3, {});
    expect_independent_and_maximal(thin_all(points, near, {}), near, 3);
  }
}

class ThinningBy : public testing::TestWithParam<std::size_t> {};

TEST_P(ThinningBy, KeepsAnIndependentSetThatEveryPointIsNearTo) {
  const Positions points = test::noisy_sphere(3000, 0.01, 2);
  const std::size_t n = points.size(), k = GetParam();
  const NeighborTable near = SpatialIndex(points, {}).nearest(24, {});
  const std::vector<Index> kept = thin_all(points, near, {}, k);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_NEAR(double(n) / double(kept.size()), 1.3 + 0.5 * double(k), 0.15 * (1.3 + 0.5 * double(k)));
  expect_independent_and_maximal(kept, near, k);
}

INSTANTIATE_TEST_SUITE_P(Neighbours, ThinningBy, testing::Values(3, 7, 13, 24));

}  // namespace
