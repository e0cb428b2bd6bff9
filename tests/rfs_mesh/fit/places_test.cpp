#include "rfs_mesh/fit/places.h"

#include <random>

#include <gtest/gtest.h>

namespace rfsmooth::rfs_mesh {
namespace {

TEST(Places, RenewFitsThoseThatAreWantedAndNoOthers) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal(0, 0.01);
  Positions points;
  for (int i = 0; i < 2000; ++i) points.emplace_back(uniform(engine), uniform(engine), normal(engine));
  const Context context;
  const SpatialIndex index(points, context);
  Places places(index, Positions(points.begin(), points.begin() + 40), 96, context);
  const std::vector<Scatter> before = places.fits(24), wide = places.fits(48, 0.02);
  std::vector<char> wanted(places.size());
  for (std::size_t s = 0; s < wanted.size(); s += 3) wanted[s] = 1;
  std::vector<Scatter> all = before;
  places.renew(all, wanted, std::vector<std::size_t>(places.size(), 48),
               std::vector<double>(places.size(), 0.02));
  for (std::size_t s = 0; s < all.size(); ++s) {
    const Scatter& expected = wanted[s] != 0 ? wide[s] : before[s];
    EXPECT_EQ(all[s].variance, expected.variance) << s;
    EXPECT_EQ(all[s].foot, expected.foot) << s;
    EXPECT_NE(wide[s].radius, before[s].radius) << s;
  }
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
