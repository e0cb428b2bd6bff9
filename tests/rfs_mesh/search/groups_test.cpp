#include "rfs_mesh/search/groups.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "tests/support/sanitized.h"
#include "tests/support/shapes.h"

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

Adjacency groups_of(const Positions& points, std::size_t members, int k = 24, const Context& context = {}) {
  return group_around_kept(points, SpatialIndex(points, context).nearest(k, context), members, context);
}

/// The groups as sets of `name[point]`.
std::set<std::vector<Index>> named(const Adjacency& groups, const std::vector<Index>& name) {
  std::set<std::vector<Index>> all;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<Index> group;
    for (const Index i : groups[g]) group.push_back(name[i]);
    std::sort(group.begin(), group.end());
    all.insert(group);
  }
  return all;
}

std::vector<Index> numbers(std::size_t n) {
  std::vector<Index> all(n);
  std::iota(all.begin(), all.end(), Index{0});
  return all;
}

class GroupsOf : public testing::TestWithParam<std::size_t> {};

TEST_P(GroupsOf, AreCompactAndOfAboutThisSize) {
  const std::size_t members = GetParam(), n = 5000;
  const test::Shape torus = test::torus();
  const Positions points = test::random_points(torus, n, 1);
  for (const int k : {24, 6}) {
    const Adjacency groups = groups_of(points, members, k);
    std::vector<Index> all = groups.items;
    std::sort(all.begin(), all.end());
    EXPECT_EQ(all, numbers(n)) << "every point is in one group";
    EXPECT_EQ(groups.start.back(), n);
    EXPECT_NEAR(double(n) / double(groups.size()), double(members), 0.25 * double(members)) << k;
    const double radius = std::sqrt(double(members) * torus.area / double(n) / M_PI);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      ASSERT_GE(groups[g].size(), 1u);
      ASSERT_LE(groups[g].size(), 5 * members);
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const Index i : groups[g]) mean += points[i] / double(groups[g].size());
      for (const Index i : groups[g]) ASSERT_LT((points[i] - mean).norm(), 4 * radius);
    }
  }
}

TEST_P(GroupsOf, KnowNeitherThePoseNorTheOrderOfThePoints) {
  const Positions points = test::random_points(test::torus(), 5000, 2);
  std::vector<Index> order = numbers(points.size());
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d(1, 2, -1).normalized());
  Positions turned(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) turned[i] = turn * points[order[i]];
  EXPECT_EQ(named(groups_of(turned, GetParam()), order),
            named(groups_of(points, GetParam()), numbers(points.size())));
}

TEST_P(GroupsOf, KnowNothingOfWhatIsFarAway) {
  const Positions points = test::random_points(test::torus(), 20000, 1);
  Positions part;
  std::vector<Index> name;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].x() >= 0) {
      part.push_back(points[i]);
      name.push_back(Index(i));
    }
  const auto whole = named(groups_of(points, GetParam()), numbers(points.size())),
             alone = named(groups_of(part, GetParam()), name);
  std::size_t far = 0;
  for (const std::vector<Index>& group : alone)
    if (points[group.front()].x() > 0.6) {
      ++far;
      EXPECT_EQ(whole.count(group), 1u);
    }
  EXPECT_GT(4 * far, alone.size());
}

TEST_P(GroupsOf, AreTheSameForAnyNumberOfThreads) {
  const Positions points = test::random_points(test::torus(), test::kSanitized ? 20000 : 50000, 1);
  const auto run = [&](int threads) {
    Context context;
    context.threads = threads;
    Adjacency groups;
    in_arena(context, [&] { groups = groups_of(points, GetParam(), 24, context); });
    return groups;
  };
  const Adjacency one = run(1), four = run(4);
  EXPECT_EQ(one.items, four.items);
  EXPECT_EQ(one.start, four.start);
}

INSTANTIATE_TEST_SUITE_P(Sizes, GroupsOf, testing::Values(8, 12, 24, 48));

TEST(Groups, OfAFewPointsAndOfPointsInOnePlace) {
  for (std::size_t n = 0; n < 8; ++n)
    for (const std::size_t members : {8, 48}) {
      const Adjacency groups = groups_of(test::random_points(test::torus(), n, 1), members);
      EXPECT_EQ(groups.items, numbers(n)) << "one group, in order";
      EXPECT_EQ(groups.size(), n == 0 ? 0u : 1u);
    }
  const Adjacency same = groups_of(Positions(1000, Eigen::Vector3d(1, 2, 3)), 48);
  EXPECT_EQ(same.items.size(), 1000u);
}

}  // namespace
