#include "rfs_mesh/search/kept_neighbors.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/awkward_clouds.h"

using rfsmooth::Positions;
using rfsmooth::rfs_mesh::KeptNeighbors;
using rfsmooth::rfs_mesh::Neighbor;
using rfsmooth::rfs_mesh::SpatialIndex;
using rfsmooth::test::AwkwardCloud;

namespace {

class Kept : public testing::TestWithParam<AwkwardCloud> {};
INSTANTIATE_TEST_SUITE_P(Clouds, Kept, testing::ValuesIn(rfsmooth::test::awkward_clouds(700)),
                         rfsmooth::test::name_of_cloud);

TEST_P(Kept, NeighborsOfAPlaceThatMovesAreThoseOfANewSearch) {
  const Positions points = GetParam().points;
  const SpatialIndex index(points, {});
  const std::size_t n = points.size();
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  std::vector<Neighbor> found, expected;
  for (std::size_t at = 0; at < n; at += 1 + n / 20) {
    KeptNeighbors kept(std::min<std::size_t>(48, n));
    Eigen::Vector3d place = points[at];
    for (const std::size_t ask : {24, 1, 24, 48, 7, 90}) {
      const std::size_t m = std::min(ask, n);
      index.nearest(place, int(m), expected);
      for (int again = 0; again < 2; ++again) {
        kept.nearest(index, place, m, found);
        EXPECT_EQ(found, expected) << m << " nearest of a place near " << at;
      }
      // From far less than the way to the neighbours to far more.
      const double way = std::sqrt(expected.back().squared_distance) * std::pow(10.0, normal(engine) - 1);
      place += way * Eigen::Vector3d(normal(engine), normal(engine), normal(engine));
    }
  }
}

}  // namespace
