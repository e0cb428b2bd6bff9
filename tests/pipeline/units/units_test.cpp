#include "pipeline/units/units.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

using namespace rfsmooth;
using namespace rfsmooth::pipeline;

namespace {

/// 1000 points evenly in a cube of this side around 0.
std::vector<double> cube(double side) {
  std::vector<double> xyz;
  for (int x = 0; x < 10; ++x)
    for (int y = 0; y < 10; ++y)
      for (int z = 0; z < 10; ++z)
        for (const int at : {x, y, z}) xyz.push_back(side * (at / 9.0 - 0.5));
  return xyz;
}

double unit_of(const std::vector<double>& xyz) {
  return working_unit(xyz.data(), xyz.size() / 3, {});
}

std::vector<double> with_stray(std::vector<double> xyz, double at) {
  xyz.insert(xyz.end(), {at, at, at});
  return xyz;
}

TEST(WorkingUnit, IsOneForUsualCloudsAndForNone) {
  for (const double side : {1e-11, 1e-3, 1.0, 1e6, 1e11}) EXPECT_EQ(unit_of(cube(side)), 1) << side;
  EXPECT_EQ(unit_of({}), 1);
  EXPECT_EQ(unit_of({5, 5, 5, 5, 5, 5}), 1);
  EXPECT_EQ(unit_of(std::vector<double>(6, std::numeric_limits<double>::quiet_NaN())), 1);
}

TEST(WorkingUnit, BringsOthersToAboutOneByAPowerOfTwo) {
  for (const double side : {1e-99, 1e-20, 1e20, 1e99}) {
    const double unit = unit_of(cube(side));
    int exponent = 0;
    EXPECT_EQ(std::frexp(unit, &exponent), 0.5) << side;
    EXPECT_GT(unit * side, 0.5) << side;
    EXPECT_LT(unit * side, 8) << side;
  }
}

TEST(WorkingUnit, IsThatOfTheCloudNotOfAStrayFarOff) {
  EXPECT_EQ(unit_of(with_stray(cube(1), 1e30)), 1);
  EXPECT_EQ(unit_of(with_stray(cube(1e-20), 1e30)), unit_of(cube(1e-20)));
  EXPECT_EQ(unit_of(with_stray(cube(1e20), 1e60)), unit_of(cube(1e20)));
  // All that is measured of most clouds is their box, which is usual here.
  EXPECT_EQ(unit_of(with_stray(cube(1e-20), 1)), 1);
}

TEST(WorkingUnit, DoesNotKnowTheOrderOfTheRows) {
  const std::vector<double> xyz = with_stray(cube(1e-20), 1e30);
  std::vector<double> reversed(xyz.rbegin(), xyz.rend());
  for (std::size_t i = 0; i < reversed.size(); i += 3) std::swap(reversed[i], reversed[i + 2]);
  EXPECT_EQ(unit_of(reversed), unit_of(xyz));
}

}  // namespace
