#include "smoothing/automatic/patches/patch_members.h"

#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <rfsmooth/result.h>

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

/// A member as it was put in.
struct PutIn {
  std::size_t patch;
  Index point;
  MemberWeight weight;
};

/// Patches of up to 40 members, near each other or anywhere, put in by `batch`.
std::vector<PutIn> put_in(PatchMembers& members, std::size_t points, std::size_t patches, std::size_t batch) {
  constexpr std::size_t kStride = 40;
  std::mt19937 random(5);
  std::vector<PutIn> all;
  members.clear(points);
  members.reserve(batch * kStride, batch * kStride);
  for (std::size_t first = 0; first < patches; first += batch) {
    std::vector<std::size_t> kept;
    std::vector<Index> point(batch * kStride);
    std::vector<MemberWeight> weight(batch * kStride);
    for (std::size_t p = first; p < std::min(patches, first + batch); ++p) {
      kept.push_back(random() % (kStride + 1));
      const bool near = random() % 4 != 0;
      for (std::size_t k = 0; k < kept.back(); ++k) {
        const std::size_t at = (p - first) * kStride + k;
        point[at] = Index(near ? (p * points / patches + k) % points : random() % points);
        weight[at] = MemberWeight(1 + random() % 65535);
        all.push_back({p, point[at], weight[at]});
      }
    }
    if (first > 0) members.reserve(kept.size() * kStride, 0);
    members.append(kept, kStride, point.data(), weight.data(), {});
  }
  return all;
}

using Told = std::vector<std::vector<std::pair<std::size_t, MemberWeight>>>;  // patches and weights by point

/// Checks that the points are told what was put in of the patches from `from` on.
void expect_told(const PatchMembers& members, std::size_t points, const std::vector<PutIn>& all,
                 std::size_t from) {
  Told expected(points), told(points);
  for (const PutIn& one : all)
    if (one.patch >= from) expected[one.point].emplace_back(one.patch, one.weight);
  members.for_each_by_point(from,
                            [&](std::size_t point, std::size_t patch, std::size_t k) {
                              EXPECT_GE(k, members.begin(patch));
                              EXPECT_LT(k, members.begin(patch) + members.size(patch));
                              told[point].emplace_back(patch, members.weight()[k]);
                            },
                            {});
  EXPECT_EQ(told, expected) << "from " << from;
}

TEST(PatchMembers, EveryPointIsToldByItsPatchesInAscendingOrder) {
  constexpr std::size_t kPoints = 50000, kPatches = 3000;  // more than three ranges of points
  PatchMembers members;
  for (const std::size_t batch : {kPatches, std::size_t(700)}) {
    const std::vector<PutIn> all = put_in(members, kPoints, kPatches, batch);
    ASSERT_EQ(members.patches(), kPatches);
    ASSERT_GT(all.size(), 30000u);
    SCOPED_TRACE(batch);
    for (const std::size_t from : {std::size_t(0), batch % kPatches, 2 * batch % kPatches})
      expect_told(members, kPoints, all, from);
  }
}

TEST(PatchMembers, AreUsedAgainForOtherPoints) {
  PatchMembers members;
  put_in(members, 50000, 300, 300);
  const std::vector<PutIn> all = put_in(members, 100, 20, 20);
  ASSERT_EQ(members.patches(), 20u);
  expect_told(members, 100, all, 0);
}

TEST(PatchMembers, RefuseMoreThanAnIndexCountsButNoSpareRoom) {
  PatchMembers members;
  members.clear(10);
  EXPECT_EQ(members.most_more(), std::size_t(kNone));
  EXPECT_THROW(members.reserve(std::size_t{1} << 32, 0), Failure);
  members.reserve(1, 0);  // and can be used afterwards
  const Index point = 3;
  const MemberWeight weight = 9;
  members.append({1}, 1, &point, &weight, {});
  EXPECT_EQ(members.patches(), 1u);
  EXPECT_EQ(members.most_more(), std::size_t(kNone) - 1);
}

}  // namespace
