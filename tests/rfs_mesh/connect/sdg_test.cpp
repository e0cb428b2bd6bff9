#include "rfs_mesh/connect/sdg.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/awkward_clouds.h"
#include "tests/support/connection.h"
#include "tests/support/shapes.h"
#include "tests/support/test_ground.h"

namespace rfsmooth::rfs_mesh {
namespace {

using test::TestGround;

/// What holds of every SDG: edges of the tree are in it or bridges, and its two forms are the same graph.
void expect_sound_sdg(const TestGround& ground, const Sdg& sdg) {
  const std::size_t n = ground.points.size();
  EXPECT_TRUE(std::is_sorted(sdg.edges.begin(), sdg.edges.end()));
  EXPECT_TRUE(std::is_sorted(sdg.bridges.begin(), sdg.bridges.end()));
  for (const Edge& e : sdg.edges) EXPECT_LT(e[0], e[1]);
  EXPECT_EQ(edges_of(sdg.graph, {}), sdg.edges);
  EXPECT_EQ(sdg.local_length.size(), n);
  for (const Edge& e : ground.tree)
    EXPECT_NE(std::binary_search(sdg.edges.begin(), sdg.edges.end(), e),
              std::binary_search(sdg.bridges.begin(), sdg.bridges.end(), e));
  EXPECT_TRUE(test::joins_all(n, sdg.edges, sdg.bridges));
}

class SdgOfAwkward : public testing::TestWithParam<test::AwkwardCloud> {};

TEST_P(SdgOfAwkward, HoldsTheTreeButForItsBridges) {
  const TestGround ground(GetParam().points);
  expect_sound_sdg(ground, ground.sdg());
}

INSTANTIATE_TEST_SUITE_P(Clouds, SdgOfAwkward, testing::ValuesIn(test::awkward_clouds(700)),
                         test::name_of_cloud);

class SdgOfShape : public testing::TestWithParam<test::Shape> {};

/// The edges that the rules added to the tree.
std::vector<Edge> added_edges(const TestGround& ground, const Sdg& sdg) {
  std::vector<Edge> tree = ground.tree, added;
  std::sort(tree.begin(), tree.end());
  std::set_difference(sdg.edges.begin(), sdg.edges.end(), tree.begin(), tree.end(),
                      std::back_inserter(added));
  return added;
}

TEST_P(SdgOfShape, AddedEdgesKeepToTheirThresholds) {
  const TestGround ground(test::poisson_points(GetParam(), 2500, 4));
  const Sdg sdg = ground.sdg();
  expect_sound_sdg(ground, sdg);
  const std::vector<Edge> added = added_edges(ground, sdg);
  ASSERT_GT(added.size(), ground.points.size() / 4) << "the tree alone is no description of a surface";
  const SdgOptions options;
  for (const Edge& e : added) {
    const Eigen::Vector3d d = ground.points[e[1]] - ground.points[e[0]];
    const double local = std::max(sdg.local_length[e[0]], sdg.local_length[e[1]]);
    EXPECT_LE(d.norm(), options.reach * local);
    const Eigen::Vector3d &m = ground.surfaces[e[0]].normal, &n = ground.surfaces[e[1]].normal;
    EXPECT_GE(std::abs(m.dot(n)), std::cos(options.normal_angle * M_PI / 180));
    for (const Eigen::Vector3d& normal : {m, n}) {
      const double rise = std::abs(normal.dot(d));
      EXPECT_LE(rise, options.steepness * std::sqrt(d.squaredNorm() - rise * rise) * (1 + 1e-9));
    }
  }
}

TEST_P(SdgOfShape, LeavesOfTheTreeGoOnAndGapsClose) {
  const TestGround ground(test::poisson_points(GetParam(), 2500, 5));
  const Sdg sdg = ground.sdg();
  const Adjacency tree = make_adjacency(ground.points.size(), ground.tree, {});
  std::size_t leaves = 0, left = 0;
  for (std::size_t v = 0; v < ground.points.size(); ++v) {
    leaves += std::size_t(tree.degree(v) == 1);
    left += std::size_t(sdg.graph.degree(v) == 1);
  }
  ASSERT_GT(leaves, ground.points.size() / 10);
  EXPECT_LT(left, leaves / 20);
}

TEST_P(SdgOfShape, TheLocalLengthIsTheMedianOfTheTreesEdgesWithinTwoHops) {
  const TestGround ground(test::random_points(GetParam(), 400, 6));
  const Sdg sdg = ground.sdg();
  ASSERT_EQ(sdg.local_length.size(), ground.points.size());
  for (Index v = 0; v < ground.points.size(); ++v) {
    // Edges that touch v, a neighbour of v, or a neighbour of one.
    std::vector<char> reached(ground.points.size(), 0);
    reached[v] = 1;
    for (int hop = 0; hop < 2; ++hop) {
      const std::vector<char> before = reached;
      for (const Edge& e : ground.tree)
        if (before[e[0]] != 0 || before[e[1]] != 0) reached[e[0]] = reached[e[1]] = 1;
    }
    std::vector<double> lengths;
    for (const Edge& e : ground.tree)
      if (reached[e[0]] != 0 || reached[e[1]] != 0)
        lengths.push_back((ground.points[e[0]] - ground.points[e[1]]).norm());
    std::sort(lengths.begin(), lengths.end());
    if (lengths.size() > 64) continue;  // more are not looked at
    EXPECT_NEAR(sdg.local_length[v], lengths[lengths.size() / 2], 1e-6);
  }
}

TEST_P(SdgOfShape, TheUnitDoesNotMatter) {
  Positions points = test::random_points(GetParam(), 1000, 7);
  const std::vector<Edge> here = TestGround(points).sdg().edges;
  for (auto& p : points) p *= 0x1p20;
  EXPECT_EQ(TestGround(points).sdg().edges, here);
}

INSTANTIATE_TEST_SUITE_P(Shapes, SdgOfShape, testing::ValuesIn(test::clean_shapes()), test::NameOfShape());

TEST(Sdg, TheEdgeBetweenTwoPartsFarFromEachOtherIsTheOneBridge) {
  Positions points = test::poisson_points(test::plane(), 500, 1);
  const std::size_t half = points.size();
  for (const auto& p : test::poisson_points(test::plane(), 500, 2)) points.emplace_back(p.x() + 3, p.y(), 0);
  const Sdg sdg = TestGround(points).sdg();
  ASSERT_EQ(sdg.bridges.size(), 1u);
  EXPECT_TRUE(sdg.bridges[0][0] < half && sdg.bridges[0][1] >= half);
  for (const Edge& e : sdg.edges) EXPECT_EQ(e[0] < half, e[1] < half);
}

TEST(Sdg, APointBetweenTwoSheetsHasNoNeighbours) {
  TestGround ground(test::poisson_points(test::plane(), 500, 3));
  ground.between.assign(ground.points.size(), 0);
  for (const Index v : {Index{7}, Index{100}, Index{301}}) ground.between[v] = 1;
  const Sdg sdg = ground.sdg();
  expect_sound_sdg(ground, sdg);
  for (const Index v : {Index{7}, Index{100}, Index{301}}) EXPECT_EQ(sdg.graph.degree(v), 0u);
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
