#include "smoothing/automatic/patches/thinning.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "rfs_mesh/search/neighbors.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

TEST(Thinning, KeepsAnIndependentSetThatEveryPointIsNearTo) {
  const Mesh mesh = [] {
    Mesh m = support::icosphere(4);
    support::add_noise(m, 0.01, 2);
    return m;
  }();
  const std::size_t n = mesh.positions.size();
  std::vector<Index> all(n);
  std::iota(all.begin(), all.end(), Index{0});
  const std::vector<Index> kept = thin(mesh.positions, all, {});
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_GT(kept.size(), n / 5);
  EXPECT_LT(kept.size(), n / 2);
  const std::set<Index> in(kept.begin(), kept.end());
  const rfs_mesh::SpatialIndex index(mesh.positions, {});
  const auto near = index.nearest(3, {});
  for (const Index k : kept)
    for (const Index j : near[k]) EXPECT_EQ(in.count(j), 0u);
  // By the neighbours of all: the same, first of all points, then of what was kept.
  const auto wide = index.nearest(32, {});
  EXPECT_EQ(thin_all(index, near, {}), kept);
  EXPECT_EQ(thin_dense(index, wide, kept, {}), thin(mesh.positions, kept, {}));
  EXPECT_EQ(thin_dense(index, near, kept, {}), thin(mesh.positions, kept, {})) << "too few in the rows";
  EXPECT_TRUE(thin(mesh.positions, {}, {}).empty());
  EXPECT_EQ(thin(mesh.positions, {4}, {}), std::vector<Index>{4});
}

}  // namespace
