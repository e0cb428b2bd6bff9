#include "smoothing/automatic/learned/surroundings.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "smoothing/automatic/learned/seen.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

constexpr double kRadius = 0.4;

/// The points of a sphere, and what neighbours know of them.
class SurroundingsTest : public testing::Test {
 protected:
  explicit SurroundingsTest(std::size_t points = 3000)
      : guide_(clouds::sample(*clouds::make_sphere(1), points, 7)),
        field_(guide_, {guide_, {}}, rfs_mesh::SpatialIndex(guide_, {}).nearest(HeightField::kNear, {}),
               guide_, {}, {}) {
    for (std::size_t i = 0; i < guide_.size(); ++i)
      packed_.push_back(
          {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(), guide_[i].cast<float>(), float(i)});
  }

  /// The points within kRadius, by their place in `guide_`.
  std::vector<float> expected(std::size_t i) const {
    std::vector<rfs_mesh::Neighbor> near;
    field_.index().within_unsorted(guide_[i], kRadius, near);
    std::vector<float> there;
    for (const auto& q : near) there.push_back(float(q.index));
    std::sort(there.begin(), there.end());
    return there;
  }

  /// Those among the columns.
  std::vector<float> found(const Surroundings& around, std::size_t i) const {
    std::vector<float> there;
    for (std::size_t k = 0; k < around.size(); ++k) {
      const Eigen::Vector3d place =
          around.origin() + Eigen::Vector3d(around.guide[0][k], around.guide[1][k], around.guide[2][k]);
      if ((place - guide_[i]).norm() <= kRadius) there.push_back(around.residual[k]);
    }
    std::sort(there.begin(), there.end());
    return there;
  }

  Positions guide_;
  HeightField field_;
  std::vector<Packed> packed_;
};

TEST_F(SurroundingsTest, HoldAllThatIsNearFromPointToPoint) {
  Surroundings around(field_, packed_);
  std::size_t searches = 0;
  for (std::size_t i = 0; i < guide_.size(); i += 7) {
    around.move_to(guide_[i], kRadius);
    searches += around.origin() == guide_[i];
    ASSERT_EQ(found(around, i), expected(i)) << i;
    ASSERT_EQ(around.size() % Surroundings::kLanes, 0U);
  }
  EXPECT_GT(searches, 1U);
}

TEST_F(SurroundingsTest, WhatIsSeenIsTheSameFromWhereverTheyWereTaken) {
  Surroundings fresh(field_, packed_), moved(field_, packed_);
  const std::size_t i = 0;
  std::size_t beside = 0;
  double nearest = 9;
  for (std::size_t j = 1; j < guide_.size(); ++j)
    if ((guide_[j] - guide_[i]).norm() < nearest) {
      nearest = (guide_[j] - guide_[i]).norm();
      beside = j;
    }
  fresh.move_to(guide_[i], kRadius);
  moved.move_to(guide_[beside], kRadius);
  moved.move_to(guide_[i], kRadius);
  ASSERT_NE(moved.origin(), fresh.origin());
  const auto sums = [&](const Surroundings& around) {
    const Eigen::Vector3f shift = (around.origin() - guide_[i]).cast<float>(), n = guide_[i].cast<float>();
    Seen seen;
    see(around,
        {{shift[0], shift[1], shift[2]}, {0, 0, 0}, {n[0], n[1], n[2]}, float(6.5 / kRadius), float(kRadius)},
        seen);
    std::vector<float> all = {total(seen.inner.all), total(seen.outer.all), total(seen.sheets.all)};
    for (const float x : seen.outer.bin) all.push_back(x);
    for (const float x : seen.moments.means()) all.push_back(x);
    return all;
  };
  const auto a = sums(fresh), b = sums(moved);
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-4) << k;
  EXPECT_GT(a[1], 5);
}

class DenseSurroundings : public SurroundingsTest {
 protected:
  static constexpr std::size_t kTimes = 10;
  DenseSurroundings() : SurroundingsTest(kTimes * Surroundings::kMost) {}
};

TEST_F(DenseSurroundings, HoldOneInSeveralPointsEvenly) {
  Surroundings around(field_, packed_);
  around.move_to(guide_[0], 2);  // all of the sphere
  EXPECT_EQ(around.stride(), kTimes);
  EXPECT_EQ(around.size(), Surroundings::kMost);
  std::size_t upper = 0;
  for (std::size_t k = 0; k < around.size(); ++k)
    upper += around.origin().z() + double(around.guide[2][k]) > 0 ? 1 : 0;
  EXPECT_NEAR(double(upper), 0.5 * double(around.size()), 0.02 * double(around.size()));
  around.move_to(9 * guide_[0], 0.2);
  EXPECT_EQ(around.stride(), 1U) << "not what an earlier place had";
}

}  // namespace
