#include "rfs_mesh/connect/emst/emst.h"

#include <atomic>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "tests/support/awkward_clouds.h"
#include "tests/support/connection.h"
#include "tests/support/threads.h"

using rfsmooth::Context;
using rfsmooth::Edge;
using rfsmooth::Index;
using rfsmooth::Positions;
using rfsmooth::rfs_mesh::emst;
using rfsmooth::rfs_mesh::SpatialIndex;
using rfsmooth::test::AwkwardCloud;
using rfsmooth::test::joins_all;
using rfsmooth::test::kruskal_length;
using rfsmooth::test::total_length;

namespace {

/// O(n^2) Prim.
double prim_length(const Positions& points) {
  if (points.empty()) return 0;
  std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
  std::vector<char> done(points.size(), 0);
  double sum = 0;
  std::size_t at = 0;
  for (std::size_t step = 1; step < points.size(); ++step) {
    done[at] = 1;
    std::size_t best = at;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (done[j]) continue;
      distance[j] = std::min(distance[j], (points[j] - points[at]).norm());
      if (distance[j] < nearest) nearest = distance[best = j];
    }
    sum += nearest;
    at = best;
  }
  return sum;
}

/// From as few neighbours as pay where there is no table: with 5 the later rounds search more than the lists
/// save, with 8 the lists cost more.
std::vector<Edge> emst_of(const Positions& points, const Context& context = {}) {
  const SpatialIndex index(points, context);
  return emst(index, index.nearest(6, context), context);
}

class Emst : public testing::TestWithParam<AwkwardCloud> {};
INSTANTIATE_TEST_SUITE_P(Clouds, Emst, testing::ValuesIn(rfsmooth::test::awkward_clouds(2000)),
                         rfsmooth::test::name_of_cloud);

TEST_P(Emst, IsASpanningTreeOfLeastTotalLength) {
  const Positions points = GetParam().points;
  const std::vector<Edge> edges = emst_of(points);
  ASSERT_EQ(edges.size(), points.empty() ? 0 : points.size() - 1);
  EXPECT_TRUE(joins_all(points.size(), edges));
  const double expected = prim_length(points);
  EXPECT_NEAR(total_length(points, edges), expected, 1e-10 * expected);
  EXPECT_NEAR(kruskal_length(points), expected, 1e-10 * expected) << "the oracle for larger clouds";
}

TEST_P(Emst, EdgesAreOrderedByLengthThenIds) {
  const Positions points = GetParam().points;
  const std::vector<Edge> edges = emst_of(points);
  ASSERT_EQ(edges.size(), points.empty() ? 0 : points.size() - 1);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    EXPECT_LT(edges[e][0], edges[e][1]);
    if (e == 0) continue;
    const double before =
        rfsmooth::rfs_mesh::squared_distance(points[edges[e - 1][0]], points[edges[e - 1][1]]);
    const double now = rfsmooth::rfs_mesh::squared_distance(points[edges[e][0]], points[edges[e][1]]);
    EXPECT_TRUE(before < now || (before == now && edges[e - 1] < edges[e]));
  }
}

TEST_P(Emst, AnySeedTableGivesTheSameTree) {
  const Positions points = GetParam().points;
  const SpatialIndex index(points, {});
  const std::vector<Edge> edges = emst_of(points);
  for (const int k : {1, 3, 20}) EXPECT_EQ(emst(index, index.nearest(k, {}), {}), edges) << k;
}

TEST_P(Emst, SameEdgesForAnyNumberOfThreads) {
  const Positions points = GetParam().points;
  const auto with_threads = [&](int threads) {
    Context context;
    context.threads = threads;
    std::vector<Edge> edges;
    rfsmooth::in_arena(context, [&] { edges = emst_of(points, context); });
    return edges;
  };
  const std::vector<Edge> one = with_threads(1);
  for (const int threads : rfsmooth::test::several_threads())
    EXPECT_EQ(with_threads(threads), one) << threads;
}

TEST(EmstOfMany, CoincidentPointsMakeAStarOfTheFirst) {
  const Positions points(50000, Eigen::Vector3d(1, 2, 3));
  const std::vector<Edge> edges = emst_of(points);
  ASSERT_EQ(edges.size(), points.size() - 1);
  for (Index e = 0; e < edges.size(); ++e) ASSERT_EQ(edges[e], (Edge{0, e + 1}));  // ties by (min id, max id)
}

TEST(EmstOfMany, TwoClustersAMillionSpacingsApartShareOneLongEdge) {
  Positions points = rfsmooth::test::noisy_sphere(25000, 0.01, 3);
  const double spacing = std::sqrt(4 * 3.14159 / 25000);
  for (const Eigen::Vector3d& p : rfsmooth::test::noisy_sphere(25000, 0.01, 4))
    points.push_back(p + Eigen::Vector3d(1e6 * spacing, 0, 0));
  const std::vector<Edge> edges = emst_of(points);
  ASSERT_EQ(edges.size(), points.size() - 1);
  EXPECT_TRUE(joins_all(points.size(), edges));
  for (std::size_t e = 0; e < edges.size(); ++e)
    EXPECT_EQ(edges[e][0] < 25000 && edges[e][1] >= 25000, e + 1 == edges.size()) << e;
}

TEST(EmstOfMany, CancelStopsIt) {
  const Positions points = rfsmooth::test::noisy_sphere(2000, 0.01, 5);
  const SpatialIndex index(points, {});
  const auto lists = index.nearest(6, {});
  const std::atomic<bool> stop{true};
  Context context;
  context.stop = &stop;
  EXPECT_THROW(emst(index, lists, context), rfsmooth::Failure);
}

TEST(EmstOfMany, ATableOfOtherPointsIsRefused) {
  const Positions points = rfsmooth::test::noisy_sphere(100, 0, 5),
                  fewer(points.begin(), points.begin() + 50);
  EXPECT_THROW(emst(SpatialIndex(points, {}), SpatialIndex(fewer, {}).nearest(6, {}), {}),
               std::invalid_argument);
}

}  // namespace
