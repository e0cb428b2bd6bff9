#include "smoothing/automatic/patches/fit/patch_fit.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/support/near.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

/// A flat guide of 20 x 20 points, jittered, and heights over it of the size of a spacing. \param bent down
/// by so much times the squared distance from the middle
struct JitteredGrid {
  explicit JitteredGrid(double bent = 0) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> jitter(-0.3, 0.3);
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < 20; ++j) {
        const double x = i + jitter(random), y = j + jitter(random);
        guide.emplace_back(x, y, -bent * ((x - 10) * (x - 10) + (y - 10) * (y - 10)));
        data.emplace_back(guide.back().x(), guide.back().y(), 2 * jitter(random));
      }
  }
  HeightField field() const {
    return {guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data, {}, {}};
  }
  Positions guide, data;
};

Eigen::Matrix<double, 6, 1> monomials(double u, double v) {
  return (Eigen::Matrix<double, 6, 1>() << 1, u, v, u * u, u * v, v * v).finished();
}

TEST(PatchFit, SaysWhatALeastSquaresFitInDoublePrecisionSays) {
  const JitteredGrid sheet;
  const HeightField field = sheet.field();
  constexpr std::size_t kMembers = 45;
  constexpr Index kSeed = 210;
  PatchFit patch(field, kMembers);
  patch.fit(kSeed, 0.5);
  ASSERT_GT(patch.size(), 40u);
  ASSERT_LE(patch.size(), kMembers);
  Eigen::Matrix<double, 6, 6> system = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  const auto at = [&](std::size_t k) {
    const Eigen::Vector3d r = (sheet.guide[patch.point()[k]] - sheet.guide[kSeed]) / 4;
    return monomials(r.x(), r.y());
  };
  for (std::size_t k = 0; k < patch.size(); ++k) {
    const double w = double(patch.weight()[k]);
    system += w * at(k) * at(k).transpose();
    right += w * field.height(patch.point()[k]) * at(k);
  }
  const Eigen::Matrix<double, 6, 6> inverse = system.inverse();
  const Eigen::Matrix<double, 6, 1> quadric = inverse * right;
  for (std::size_t k = 0; k < patch.size(); ++k) {
    EXPECT_NEAR(double(patch.height()[k]), quadric.dot(at(k)), 1e-4);
    const double influence = double(kMemberUnit) * at(k).dot(inverse * at(k));
    EXPECT_NEAR(double(patch.own()[k]), influence, 1e-3 * influence);
  }
}

TEST(PatchFit, MembersAreTheNearestAndWeighLessTheFartherTheyAre) {
  const JitteredGrid sheet;
  const HeightField field = sheet.field();
  constexpr std::size_t kMembers = 30;
  constexpr Index kSeed = 187;
  PatchFit patch(field, kMembers);
  patch.fit(kSeed, 1);
  std::vector<rfs_mesh::Neighbor> nearest;
  field.index().nearest(sheet.guide[kSeed], int(kMembers), nearest);
  ASSERT_EQ(patch.size(), nearest.size());
  double farthest = 0, lightest = 1e9;
  for (std::size_t k = 0; k < patch.size(); ++k) {
    const Index i = patch.point()[k];
    EXPECT_TRUE(std::any_of(nearest.begin(), nearest.end(), [&](const auto& n) { return n.index == i; }));
    farthest = std::max(farthest, (sheet.guide[i] - sheet.guide[kSeed]).squaredNorm());
  }
  for (std::size_t k = 0; k < patch.size(); ++k) {
    const double square =
        (sheet.guide[patch.point()[k]] - sheet.guide[kSeed]).squaredNorm() / (1.1 * farthest);
    EXPECT_NEAR(double(patch.weight()[k]) / double(kMemberUnit), (1 - square) * (1 - square), 1e-4);
    lightest = std::min(lightest, double(patch.weight()[k]));
  }
  EXPECT_GT(lightest, 0);
}

TEST(PatchFit, RoughPlacesSaySoAndCountLess) {
  const JitteredGrid sheet;
  const HeightField field = sheet.field();
  PatchFit patch(field, 60);
  patch.fit(210, 5);
  EXPECT_FALSE(patch.several());
  EXPECT_EQ(patch.say(), 1);
  patch.fit(210, 0.1);
  EXPECT_TRUE(patch.several());
  EXPECT_LT(patch.say(), 0.1);
  EXPECT_GT(patch.say(), 0);
}

// On a bent guide the quadric is over the tangent plane, and what it says along the normals of others.
TEST(PatchFit, SaysHeightsAlongThePointsOwnNormals) {
  JitteredGrid sheet(0.02);
  const HeightField normals = sheet.field();
  for (std::size_t i = 0; i < sheet.guide.size(); ++i)
    sheet.data[i] = sheet.guide[i] + (normals.normal(i).z() > 0 ? 0.3 : -0.3) * normals.normal(i);
  const HeightField field = sheet.field();
  PatchFit patch(field, 40);
  patch.fit(210, 0.1);
  ASSERT_GT(patch.size(), 35u);
  for (std::size_t k = 0; k < patch.size(); ++k)
    EXPECT_NEAR(double(patch.height()[k]), field.height(patch.point()[k]), 0.02);
}

// Of members in a line the normal equations say next to nothing across it; A^-1 itself, in single precision,
// has no digits left there.
TEST(PatchFit, SharesAddUpToThoseOfAParabolaWhereMembersLieInALine) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  for (const double beside : {0.0, 1e-3, 1e-2}) {
    Positions guide, data;
    for (int i = 0; i < 64; ++i) {
      const double off = beside * noise(random);
      guide.emplace_back(0.8 * i - 0.6 * off, 0.6 * i + 0.8 * off, 0);
      data.push_back(guide.back() + Eigen::Vector3d(0, 0, 0.1 * noise(random)));
    }
    const HeightField field(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data, {}, {});
    PatchFit patch(field, 16);
    patch.fit(30, 0.1);
    ASSERT_GE(patch.size(), 8u);
    double shares = 0;
    for (std::size_t k = 0; k < patch.size(); ++k) {
      EXPECT_GE(patch.own()[k], 0);
      const double share = double(patch.own()[k]) * double(patch.weight()[k]) / double(kMemberUnit);
      EXPECT_LE(share, 1.001);
      shares += share;
    }
    // The trace of a projection: as many as coefficients can be told, 3 along the line, at most 6.
    EXPECT_GT(shares, 2.9) << beside;
    EXPECT_LT(shares, 6.01) << beside;
  }
}

TEST(PatchFit, PointsAtOnePlaceGiveNumbers) {
  JitteredGrid sheet;
  for (std::size_t i = 0; i < 60; ++i) sheet.guide[i] = sheet.guide[0];
  const HeightField field = sheet.field();
  PatchFit patch(field, 16);
  patch.fit(0, 1);
  ASSERT_GT(patch.size(), 0u);
  for (std::size_t k = 0; k < patch.size(); ++k) {
    EXPECT_TRUE(std::isfinite(patch.height()[k]));
    EXPECT_TRUE(std::isfinite(patch.own()[k]));
  }
}

}  // namespace
