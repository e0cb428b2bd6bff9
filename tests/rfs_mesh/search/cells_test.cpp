#include "rfs_mesh/search/cells.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "tests/support/shapes.h"

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

const Eigen::Vector3d kCorner(0, 0.05, -0.1);
constexpr double kEdge = 0.3;
constexpr std::size_t kMembers = 10;

TEST(Cells, EveryPointIsInOneSmallGroupOfOneCube) {
  const Positions points = test::random_points(test::torus(), 5000, 1);
  const Groups groups = group_in_cells(points, kCorner, kEdge, kMembers, {});
  std::vector<Index> members = groups.member;
  std::sort(members.begin(), members.end());
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ(members[i], i);
  ASSERT_EQ(groups.start.back(), points.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    ASSERT_GE(groups[g].size(), 1u);
    ASSERT_LE(2 * groups[g].size(), 3 * kMembers);
    const Eigen::Array3d cube = ((points[*groups[g].begin()] - kCorner).array() / kEdge).floor();
    for (const Index i : groups[g])
      ASSERT_TRUE((((points[i] - kCorner).array() / kEdge).floor() == cube).all());
  }
  EXPECT_LT(groups.size(), 3 * points.size() / kMembers) << "most cubes hold several groups";
}

TEST(Cells, OneCubeHasGroupsOfNearlyTheSameSize) {
  const Positions points = test::random_points(test::torus(), 5000, 1);
  const Groups groups = group_in_cells(points, kCorner, 0, kMembers, {});
  for (std::size_t g = 0; g < groups.size(); ++g) ASSERT_GE(4 * groups[g].size(), 3 * kMembers - 4);
}

TEST(Cells, WhatIsFarAwayHasNoSay) {
  const Positions points = test::random_points(test::torus(), 5000, 1);
  Positions part;  // all points of the cubes with x >= 0, numbered anew
  std::vector<Index> number;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].x() >= 0) {
      part.push_back(points[i]);
      number.push_back(Index(i));
    }
  ASSERT_GT(part.size(), points.size() / 4);
  const Groups whole = group_in_cells(points, kCorner, kEdge, kMembers, {}),
               alone = group_in_cells(part, kCorner, kEdge, kMembers, {});
  std::set<std::vector<Index>> of_whole;
  for (std::size_t g = 0; g < whole.size(); ++g) of_whole.insert({whole[g].begin(), whole[g].end()});
  for (std::size_t g = 0; g < alone.size(); ++g) {
    std::vector<Index> group;
    for (const Index i : alone[g]) group.push_back(number[i]);
    EXPECT_EQ(of_whole.count(group), 1u);
  }
}

TEST(Cells, SameGroupsForAnyNumberOfThreads) {
  const Positions points = test::random_points(test::torus(), 100000, 1);
  const auto run = [&](int threads) {
    Context context;
    context.threads = threads;
    Groups groups;
    in_arena(context, [&] { groups = group_in_cells(points, kCorner, kEdge, kMembers, context); });
    return groups;
  };
  const Groups one = run(1), four = run(4);
  EXPECT_EQ(one.member, four.member);
  EXPECT_EQ(one.start, four.start);
}

}  // namespace
