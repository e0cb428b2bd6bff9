#include "pipeline/normals/normal_sides.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::pipeline {
namespace {

/// Two sheets of 40 x 40 points, half a spacing apart, their normals away from each other.
struct Sheets {
  Positions points, normals;
};

Sheets sheets() {
  Sheets s;
  for (const double side : {-1.0, 1.0})
    for (int i = 0; i < 1600; ++i) {
      s.points.emplace_back(i % 40 + 0.25 * side, i / 40, 0.25 * side);
      s.normals.emplace_back(0, 0, side);
    }
  return s;
}

bool keep(const Sheets& s, const Positions& before, Positions& normals) {
  return keep_sides(s.points.front().data(), s.points.size(), before.front().data(), normals.front().data(),
                    {});
}

/// Each normal as it is with probability `share`, else turned over.
Positions thrown_over(Positions normals, double share) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> uniform;
  for (auto& normal : normals)
    if (uniform(engine) >= share) normal = -normal;
  return normals;
}

Positions negative(Positions normals) {
  for (auto& normal : normals) normal = -normal;
  return normals;
}

TEST(NormalSides, StayOnBothSidesOfAThinSheetThoughSomeWereThrownOver) {
  const Sheets s = sheets();
  const Positions before = thrown_over(s.normals, 0.85);
  for (const bool outward : {true, false}) {
    Positions normals = s.normals;
    EXPECT_TRUE(keep(s, outward ? before : negative(before), normals));
    EXPECT_EQ(normals, outward ? s.normals : negative(s.normals));
  }
}

TEST(NormalSides, LengthsDoNotCountAndRowsWithoutANormalSayNothing) {
  const Sheets s = sheets();
  Positions before = negative(s.normals), normals = s.normals;
  for (std::size_t i = 0; i < before.size(); ++i) before[i] *= i % 3 == 0 ? 1e-6 : 1e6;
  for (std::size_t i = 0; i < before.size(); i += 5) before[i].setZero();
  for (std::size_t i = 0; i < before.size(); i += 7)
    before[i].setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(keep(s, before, normals));
  EXPECT_EQ(normals, negative(s.normals));
}

TEST(NormalSides, NormalsWithoutACommonSideAreNotFollowed) {
  const Sheets s = sheets();
  Positions normals = s.normals;
  EXPECT_FALSE(keep(s, thrown_over(s.normals, 0.5), normals));
  EXPECT_EQ(normals, s.normals);
  EXPECT_FALSE(keep(s, Positions(s.normals.size(), Eigen::Vector3d::Zero()), normals));
  EXPECT_EQ(normals, s.normals);
}

TEST(NormalSides, AnyNumberOfPointsWillDo) {
  for (std::size_t n = 0; n < 4; ++n) {
    Sheets s = sheets();
    s.points.resize(n);
    s.normals.resize(n);
    Positions normals = s.normals;
    const Positions before = negative(normals);
    EXPECT_EQ(
        keep_sides(n == 0 ? nullptr : s.points.front().data(), n, n == 0 ? nullptr : before.front().data(),
                   n == 0 ? nullptr : normals.front().data(), {}),
        n > 0);
    EXPECT_EQ(normals, before);
  }
}

}  // namespace
}  // namespace rfsmooth::pipeline
