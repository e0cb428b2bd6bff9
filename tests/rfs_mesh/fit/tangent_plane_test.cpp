#include "rfs_mesh/fit/tangent_plane.h"

#include <random>

#include <gtest/gtest.h>

using namespace rfsmooth::rfs_mesh;

namespace {

Eigen::Vector2d unit_at(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

TEST(TangentPlane, DirectionIsTheArcTangent) {
  for (int k = -18000; k <= 18000; ++k) {
    const double angle = radians(0.01 * k), x = 3 * std::cos(angle), y = 3 * std::sin(angle);
    ASSERT_LT(std::abs(std::remainder(direction(x, y) - std::atan2(y, x), 2 * M_PI)), 1.5e-5) << angle;
  }
  EXPECT_EQ(direction(0, 0), 0);
  EXPECT_EQ(direction(1, 0), 0);
  EXPECT_EQ(direction(-1, 0), M_PI);
}

TEST(TangentPlane, SectorHoldsWhatTurnsIntoIt) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI), wide(0, 2 * M_PI);
  for (int trial = 0; trial < 10000; ++trial) {
    const double from = angle(engine), width = wide(engine), to = angle(engine);
    const Sector sector(unit_at(from), unit_at(from + width), width);
    EXPECT_EQ(sector.holds(2 * unit_at(to)), turn(from, to) <= width) << from << " " << width << " " << to;
  }
  EXPECT_FALSE(Sector(unit_at(0), unit_at(-0.1), -0.1).holds({1, 0}));
}

}  // namespace
