#include "smoothing/automatic/rows/near_rows.h"

#include <algorithm>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace rfsmooth::smoothing {
namespace {

/// Rows of any indices: of the next points, of the farthest, of all in between.
rfs_mesh::NeighborTable scattered(std::size_t n, int k) {
  rfs_mesh::NeighborTable table;
  table.k = k;
  std::mt19937 random(1);
  for (std::size_t i = 0; i < n; ++i)
    for (int j = 0; j < k; ++j)
      table.items.push_back(i / 1000 % 2 == 0 ? Index((i + std::size_t(j)) % n) : Index(random() % n));
  return table;
}

TEST(NearRows, SayWhatTheTableSaid) {
  for (const int k : {1, 5, 32}) {
    const std::size_t n = 100'001;
    const rfs_mesh::NeighborTable table = scattered(n, k);
    const NearRows rows(table, {});
    ASSERT_EQ(rows.size(), n);
    ASSERT_EQ(rows.width(), std::size_t(k));
    for (std::size_t i = 0; i < n; ++i) {
      const auto row = rows[i];
      ASSERT_TRUE(std::equal(row.begin(), row.end(), table[i].begin(), table[i].end()));
    }
    EXPECT_EQ(rows.first(32, {}).items, table.items);
    const rfs_mesh::NeighborTable three = rows.first(3, {});
    ASSERT_EQ(three.k, std::min(3, k));
    for (std::size_t i = 0; i < n; ++i)
      ASSERT_TRUE(std::equal(three[i].begin(), three[i].end(), table[i].begin()));
  }
}

TEST(NearRows, OfNothingAreNone) {
  EXPECT_EQ(NearRows().size(), 0U);
  EXPECT_EQ(NearRows({}, {}).size(), 0U);
}

TEST(NearRows, RefuseLongRows) {
  EXPECT_THROW(NearRows(scattered(50, 33), {}), std::invalid_argument);
}

}  // namespace
}  // namespace rfsmooth::smoothing
