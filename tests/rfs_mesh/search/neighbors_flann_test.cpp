// The second oracle of the neighbours' tests: FLANN, which the paper's implementation would use.
#include <gtest/gtest.h>

#include "rfs_mesh/search/neighbors.h"
#include "tests/bench/peers/index_peers.h"
#include "tests/support/awkward_clouds.h"

using rfsmooth::Index;
using rfsmooth::Positions;
using rfsmooth::rfs_mesh::SpatialIndex;
using rfsmooth::test::AwkwardCloud;

namespace {

class NeighborsBesideFlann : public testing::TestWithParam<AwkwardCloud> {};
INSTANTIATE_TEST_SUITE_P(Clouds, NeighborsBesideFlann,
                         testing::ValuesIn(rfsmooth::test::awkward_clouds(2000)),
                         rfsmooth::test::name_of_cloud);

/// FLANN takes any of several points at the same distance, so distances are compared, rounding apart.
TEST_P(NeighborsBesideFlann, AreAsNear) {
  constexpr int kNear = 12;
  const Positions& points = GetParam().points;
  const std::size_t n = points.size();
  const auto table = SpatialIndex(points, {}).nearest(kNear, {});
  if (n <= kNear) {
    EXPECT_LT(table.k, kNear);
    return;
  }
  const auto flann = rfsmooth::bench::peers::flann_index(points[0].data(), n);
  std::vector<std::uint32_t> rows(n * (kNear + 1));
  flann->nearest(0, n, kNear + 1, rows.data());
  for (std::size_t i = 0; i < n; ++i)
    for (int place = 0; place < kNear; ++place) {
      // FLANN's row begins with the point itself, or with another at its place.
      const double theirs = (points[rows[i * (kNear + 1) + std::size_t(place) + 1]] - points[i]).norm();
      const double ours = (points[table[i][std::size_t(place)]] - points[i]).norm();
      ASSERT_NEAR(ours, theirs, 1e-9 * (ours + points[i].norm())) << "point " << i << ", place " << place;
    }
}

}  // namespace
