#include "rfs_mesh/connect/edge_swap.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <rfsmooth/connect.h>

#include "rfs_mesh/measure.h"
#include "tests/support/edge_census.h"
#include "tests/support/shapes.h"
#include "tests/support/threads.h"

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

/// Two slopes that meet in a ridge from 0 to 2, each continued in its own plane by two more faces; the pair
/// in the middle shares the ridge, or the diagonal across it.
Mesh roof(bool along_the_ridge) {
  Mesh mesh;
  auto& p = mesh.positions;
  p = {{0, 0, 1}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}};
  p.insert(p.end(), {p[0] + p[1] - p[2], p[1] + p[2] - p[0], p[2] + p[3] - p[0], p[3] + p[0] - p[2]});
  if (along_the_ridge)
    mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  else
    mesh.faces = {{0, 1, 3}, {1, 2, 3}};
  mesh.faces.insert(mesh.faces.end(), {{1, 0, 4}, {2, 1, 5}, {3, 2, 6}, {0, 3, 7}});
  rebuild_adjacency(mesh, {});
  return mesh;
}

TEST(EdgeSwap, FindsTheRidgeOfARoof) {
  Mesh mesh = roof(false);
  EXPECT_EQ(swap_edges(mesh, {}, {}), 1u);
  EXPECT_TRUE(check(mesh).empty());
  EXPECT_TRUE(std::binary_search(mesh.one_ring[0].begin(), mesh.one_ring[0].end(), 2u));
  EXPECT_FALSE(std::binary_search(mesh.one_ring[1].begin(), mesh.one_ring[1].end(), 3u));
  EXPECT_NEAR(test::edge_census(mesh).dihedral_angle_sum, test::edge_census(roof(true)).dihedral_angle_sum,
              1e-12);
  ASSERT_EQ(mesh.faces.size(), 6u);
  for (const Face& f : mesh.faces) EXPECT_GT(face_cross(mesh.positions, f)[2], 0) << "wound the other way";
}

TEST(EdgeSwap, LeavesTheRidgeOfARoof) {
  Mesh mesh = roof(true);
  EXPECT_EQ(swap_edges(mesh, {}, {}), 0u);
}

TEST(EdgeSwap, NeverMakesAnEdgeThatIsThere) {
  Mesh mesh = roof(false);
  mesh.loose_edges = {{0, 2}};
  rebuild_adjacency(mesh, {});
  EXPECT_EQ(swap_edges(mesh, {}, {}), 0u);
}

class SwapOnShape : public testing::TestWithParam<test::Shape> {};

TEST_P(SwapOnShape, NeverLowersTheSumOfDihedralAnglesAndKeepsTheMeshSound) {
  Positions points = random_points(GetParam(), 3000, 9);
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal(0, 0.3 * std::sqrt(GetParam().area / 3000));
  for (auto& p : points) p += Eigen::Vector3d(normal(engine), normal(engine), normal(engine));
  Mesh mesh = connect(points, {}, {}).value().mesh;
  const std::size_t faces = mesh.faces.size();
  double sum = test::edge_census(mesh).dihedral_angle_sum;
  for (int pass = 0; pass < 5; ++pass) {
    const std::size_t swaps = swap_edges(mesh, {}, {});
    const double now = test::edge_census(mesh).dihedral_angle_sum;
    EXPECT_GE(now, sum + 1e-3 * double(swaps) - 1e-6) << "every swap must pay its least gain";
    EXPECT_TRUE(pass > 0 || swaps > 0) << "noise leaves nothing to swap? the test would prove nothing";
    sum = now;
    EXPECT_TRUE(check(mesh).empty());
    EXPECT_EQ(mesh.faces.size(), faces);
    EXPECT_EQ(test::edge_census(mesh).crowded, 0u);
    EXPECT_TRUE(mesh.positions == points);
  }
}

TEST_P(SwapOnShape, SameBytesForAnyNumberOfThreads) {
  const Mesh mesh = connect(random_points(GetParam(), 3000, 9), {}, {}).value().mesh;
  Mesh one = mesh;
  Context context;
  context.threads = 1;
  swap_edges(one, {}, context);
  for (const int threads : test::several_threads()) {
    Mesh many = mesh;
    context.threads = threads;
    swap_edges(many, {}, context);
    EXPECT_EQ(one.faces, many.faces);
    EXPECT_EQ(one.one_ring.items, many.one_ring.items);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SwapOnShape, testing::ValuesIn(test::clean_shapes()), test::NameOfShape());

}  // namespace
