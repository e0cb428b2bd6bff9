#include "rfs_mesh/search/neighbors.h"

#include <algorithm>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "tests/support/awkward_clouds.h"
#include "tests/support/threads.h"

using rfsmooth::Context;
using rfsmooth::Index;
using rfsmooth::kNone;
using rfsmooth::Positions;
using rfsmooth::rfs_mesh::KdTree;
using rfsmooth::rfs_mesh::Neighbor;
using rfsmooth::rfs_mesh::NeighborTable;
using rfsmooth::rfs_mesh::SpatialIndex;
using rfsmooth::test::AwkwardCloud;

namespace {

/// Every point but `self`, ascending by (distance, index).
std::vector<Neighbor> all_sorted(const Positions& points, const Eigen::Vector3d& q, Index self) {
  std::vector<Neighbor> all;
  for (Index j = 0; j < points.size(); ++j) {
    const Eigen::Vector3d d = points[j] - q;
    if (j != self) all.push_back({j, (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]});
  }
  std::sort(all.begin(), all.end());
  return all;
}

class Neighbors : public testing::TestWithParam<AwkwardCloud> {};
INSTANTIATE_TEST_SUITE_P(Clouds, Neighbors, testing::ValuesIn(rfsmooth::test::awkward_clouds(700)),
                         rfsmooth::test::name_of_cloud);

TEST_P(Neighbors, NearestOfEveryPointMatchBruteForceIncludingTies) {
  const Positions points = GetParam().points;
  const SpatialIndex index(points, {});
  for (const int k : {1, 8, 33}) {
    const NeighborTable table = index.nearest(k, {});
    ASSERT_EQ(table.k, points.size() < 2 ? 0 : std::min(k, int(points.size()) - 1));
    if (table.k == 0) continue;
    ASSERT_EQ(table.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::vector<Neighbor> expected = all_sorted(points, points[i], Index(i));
      const auto row = table[i];
      ASSERT_EQ(int(row.size()), table.k);
      for (std::size_t j = 0; j < row.size(); ++j)
        ASSERT_EQ(row[j], expected[j].index) << "k " << k << " point " << i << " place " << j;
    }
  }
}

TEST_P(Neighbors, OfATreeMadeAgainFromItsOrderAreTheSame) {
  const Positions points = GetParam().points;
  const SpatialIndex index(points, {}), again(points, KdTree(index.tree().order()), {});
  ASSERT_EQ(again.tree().node_count(), index.tree().node_count());
  for (std::uint32_t i = 0; i < index.tree().node_count(); ++i) {
    const KdTree::Node &one = index.tree().node(i), &other = again.tree().node(i);
    ASSERT_TRUE(one.low == other.low && one.high == other.high && one.least_id == other.least_id);
  }
  EXPECT_EQ(again.nearest(8, {}).items, index.nearest(8, {}).items);
}

TEST_P(Neighbors, QueriesAnywhereMatchBruteForce) {
  const Positions points = GetParam().points;
  const SpatialIndex index(points, {});
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  std::vector<Neighbor> found;
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Vector3d q(normal(engine), normal(engine), normal(engine));
    if (!points.empty()) q = points[engine() % points.size()] + (trial % 3) * 0.1 * q;
    std::vector<Neighbor> expected = all_sorted(points, q, kNone);
    const double radius =
        expected.empty()
            ? 1
            : std::sqrt(expected[std::min<std::size_t>(20, expected.size() - 1)].squared_distance);
    index.within(q, radius, found);
    const auto outside = [&](const Neighbor& e) { return e.squared_distance > radius * radius; };
    EXPECT_EQ(found, std::vector<Neighbor>(expected.begin(),
                                           std::find_if(expected.begin(), expected.end(), outside)));
    EXPECT_EQ(index.any_within(q, radius), !found.empty());
    if (!expected.empty()) {
      const double nearest = std::sqrt(expected[0].squared_distance);
      EXPECT_TRUE(index.any_within(q, 1.001 * nearest));
      EXPECT_EQ(index.any_within(q, 0.999 * nearest), nearest == 0);
    }
    for (const std::size_t k : {200, 12}) {  // long lists are kept another way than short ones
      index.nearest(q, int(k), found);
      expected.resize(std::min(expected.size(), k));
      EXPECT_EQ(found, expected);
    }
  }
}

TEST_P(Neighbors, ThoseThatStayMatchBruteForce) {
  const Positions points = GetParam().points;
  const SpatialIndex index(points, {});
  std::vector<Neighbor> found;
  for (const std::size_t gone_but : {1, 4, 1000}) {  // one in so many stays
    std::vector<char> gone(points.size(), 1);
    for (std::size_t i = 0; i < gone.size(); i += gone_but) gone[i] = 0;
    const SpatialIndex left = index.without(gone, {});
    for (std::size_t at = 0; at < points.size(); at += 50) {
      std::vector<Neighbor> expected = all_sorted(points, points[at], kNone);
      expected.erase(std::remove_if(expected.begin(), expected.end(),
                                    [&](const Neighbor& e) { return gone[e.index] != 0; }),
                     expected.end());
      for (const std::size_t k : {200, 12}) {
        expected.resize(std::min(expected.size(), k));
        for (const double bound :
             {std::numeric_limits<double>::infinity(), expected.back().squared_distance}) {
          left.nearest_within(points[at], int(k), bound, found);
          EXPECT_EQ(found, expected);
        }
      }
    }
  }
}

TEST_P(Neighbors, TheNearestWithinABoundAreThoseOfAllThatAreSoNear) {
  const Positions points = GetParam().points;
  const SpatialIndex index(points, {});
  std::vector<Neighbor> found, expected;
  for (std::size_t at = 0; at < points.size(); at += 50)
    for (const std::size_t k : {200, 12})
      for (const std::size_t farthest : {0, 5, 50}) {
        expected = all_sorted(points, points[at], kNone);
        const double bound = expected[std::min(farthest, expected.size() - 1)].squared_distance;
        index.nearest_within(points[at], int(k), bound, found);
        const auto outside = [&](const Neighbor& e) { return e.squared_distance > bound; };
        expected.erase(std::find_if(expected.begin(), expected.end(), outside), expected.end());
        expected.resize(std::min(expected.size(), k));
        EXPECT_EQ(found, expected);
      }
}

TEST(Neighbors, OfATreeThatFollowsItsPointsAreThoseOfANewOne) {
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal;
  Positions points(9001);
  for (Eigen::Vector3d& p : points) p = {normal(engine), normal(engine), normal(engine)};
  SpatialIndex index(points, {});
  Positions moved = points;
  for (Eigen::Vector3d& p : moved) p += Eigen::Vector3d(1, 0, 0.3 * normal(engine));
  const SpatialIndex after(moved, index.release_tree(), {}), fresh(moved, {});
  EXPECT_EQ(after.nearest(12, {}).items, fresh.nearest(12, {}).items);
  std::vector<Neighbor> found, expected;
  after.nearest({1, 0.5, 0}, 40, found);
  fresh.nearest({1, 0.5, 0}, 40, expected);
  EXPECT_EQ(found, expected);
  moved[77].x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(SpatialIndex(moved, SpatialIndex(points, {}).release_tree(), {}), std::invalid_argument);
}

TEST(Neighbors, OnlyRowsThatAreWantedAreRenewed) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> uniform;
  Positions points(500);
  for (Eigen::Vector3d& p : points) p = {uniform(engine), uniform(engine), uniform(engine)};
  const SpatialIndex index(points, {});
  const NeighborTable exact = index.nearest(9, {});
  NeighborTable table = exact;
  std::fill(table.items.begin(), table.items.end(), kNone);
  std::vector<char> wanted(points.size());
  for (std::size_t i = 0; i < points.size(); i += 7) wanted[i] = 1;
  index.renew(table, wanted, {});
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < 9; ++k) EXPECT_EQ(table[i][k], wanted[i] != 0 ? exact[i][k] : kNone);
}

TEST(Neighbors, SameTableForAnyNumberOfThreads) {
  const Positions points = rfsmooth::test::noisy_sphere(30000, 0.01, 1);
  const auto with_threads = [&](int threads) {
    Context context;
    context.threads = threads;
    decltype(NeighborTable::items) items;
    rfsmooth::in_arena(context, [&] { items = SpatialIndex(points, context).nearest(8, context).items; });
    return items;
  };
  const auto one = with_threads(1);
  for (const int threads : rfsmooth::test::several_threads())
    EXPECT_EQ(with_threads(threads), one) << threads;
}

TEST(Neighbors, NonFinitePointsAreRefused) {
  Positions points = rfsmooth::test::noisy_sphere(100, 0, 1);
  points[50][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(SpatialIndex(points, {}), std::invalid_argument);
}

TEST(Neighbors, CancelStopsTheSearch) {
  const Positions points = rfsmooth::test::noisy_sphere(1000, 0, 1);
  const SpatialIndex index(points, {});
  const std::atomic<bool> stop{true};
  Context context;
  context.stop = &stop;
  EXPECT_THROW(index.nearest(8, context), rfsmooth::Failure);
  EXPECT_THROW(SpatialIndex(points, context), rfsmooth::Failure);
}

TEST(Neighbors, NearestToEachOfManyPlaces) {
  const Positions points = rfsmooth::test::noisy_sphere(3000, 0.1, 1),
                  places = rfsmooth::test::noisy_sphere(5000, 0.3, 2);
  const SpatialIndex index(points, {});
  const std::vector<Index> nearest = nearest_points(index, places, {});
  ASSERT_EQ(nearest.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    for (const Eigen::Vector3d& p : points)
      ASSERT_LE((places[i] - points[nearest[i]]).squaredNorm(), (places[i] - p).squaredNorm() + 1e-15);
}

TEST(Neighbors, OfWhatIsLeftAreThoseOfTheRestAlone) {
  const Positions points = rfsmooth::test::noisy_sphere(2000, 0.1, 1);
  const NeighborTable near = SpatialIndex(points, {}).nearest(9, {});
  for (const std::size_t every : {1000, 7, 2, 1}) {
    std::vector<char> gone(points.size(), 0);
    for (std::size_t i = 0; i + 5 < points.size(); i += every) gone[i] = 1;
    Positions rest;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (gone[i] == 0) rest.push_back(points[i]);
    const SpatialIndex left(rest, {});
    const NeighborTable expected = left.nearest(9, {}), found = nearest_left(near, gone, left, {});
    EXPECT_EQ(found.k, expected.k) << every;
    EXPECT_EQ(found.items, expected.items) << every;
  }
}

}  // namespace
