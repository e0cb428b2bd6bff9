#include "rfs_mesh/search/wide_neighbors.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/awkward_clouds.h"

using rfsmooth::Index;
using rfsmooth::Positions;
using rfsmooth::rfs_mesh::Neighbor;
using rfsmooth::rfs_mesh::SpatialIndex;
using rfsmooth::rfs_mesh::WideNeighbors;
using rfsmooth::test::AwkwardCloud;

namespace {

class Wide : public testing::TestWithParam<AwkwardCloud> {};
INSTANTIATE_TEST_SUITE_P(Clouds, Wide, testing::ValuesIn(rfsmooth::test::awkward_clouds(700)),
                         rfsmooth::test::name_of_cloud);

TEST_P(Wide, AreTheNearestWithTheirOffsets) {
  const Positions points = GetParam().points;
  const SpatialIndex index(points, {});
  std::mt19937_64 engine(3);
  std::vector<Neighbor> expected;
  for (const std::size_t k : {1, 20, 300, 5000}) {
    WideNeighbors near(index, k);
    for (int trial = 0; trial < 50 && !points.empty(); ++trial) {
      const Eigen::Vector3d place =
          points[engine() % points.size()] + Eigen::Vector3d(0.01 * (trial % 2), 0, 0);
      near.find(place);
      index.nearest(place, int(k), expected);
      ASSERT_EQ(near.size(), expected.size());
      const double reach = std::sqrt(expected.back().squared_distance), close = 1e-5 * near.unit();
      EXPECT_NEAR(std::sqrt(double(near.farthest())) * near.unit(), reach, close);
      std::vector<Index> ids(near.index(), near.index() + near.size());
      std::sort(ids.begin(), ids.end());
      EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
      for (std::size_t j = 0; j < near.size(); ++j) {
        const Eigen::Vector3d off = Eigen::Vector3d(near.x()[j], near.y()[j], near.z()[j]) * near.unit();
        const Eigen::Vector3d exact = points[near.index()[j]] - place;
        EXPECT_LE((off - exact).norm(), close);
        EXPECT_LE(exact.norm(), reach + close);
        EXPECT_NEAR(std::sqrt(double(near.squared()[j])) * near.unit(), exact.norm(), close);
      }
    }
  }
}

TEST_P(Wide, DoNotDependOnWhatWasFoundBefore) {
  const Positions points = GetParam().points;
  if (points.size() < 40) return;
  const SpatialIndex index(points, {});
  WideNeighbors near(index, 30);
  for (std::size_t i = 0; i < points.size(); i += 37) {
    near.find(points[i]);
    WideNeighbors fresh(index, 30);
    fresh.find(points[i]);
    EXPECT_NEAR(double(near.farthest()) * near.unit() * near.unit(),
                double(fresh.farthest()) * fresh.unit() * fresh.unit(), 1e-5 * fresh.unit() * fresh.unit());
  }
}

}  // namespace
