#include "pipeline/row_order.h"

#include <cmath>

#include <gtest/gtest.h>

namespace {

TEST(RowOrder, HasTheFirstRowOfEveryPoint) {
  const double nan = std::nan("");
  // Rows 1 and 4 are of one point, as are 2 and 5; of rows 0 and 3 only the latter is finite.
  const std::vector<double> xyz = {nan, 0, 0, 5, 0, 0, 1, 2, 0, 9, 0, 0, 5, 0, 0, 1, 2, 0};
  const auto cloud = rfsmooth::rfs_mesh::make_working_cloud(xyz.data(), xyz.size() / 3, {}).value();
  const auto order = rfsmooth::pipeline::row_order(cloud);
  EXPECT_EQ(order.row, (std::vector<std::size_t>{1, 2, 3}));
  ASSERT_EQ(order.rank.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(order.rank[cloud.of_input[order.row[k]]], k);
}

}  // namespace
