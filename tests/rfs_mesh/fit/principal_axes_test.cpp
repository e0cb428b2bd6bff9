#include "rfs_mesh/fit/principal_axes.h"

#include <gtest/gtest.h>

namespace rfsmooth::rfs_mesh {
namespace {

/// Indices of all points; the distances are not asked for.
std::vector<Neighbor> all_of(const Positions& points) {
  std::vector<Neighbor> out;
  for (std::size_t i = 0; i < points.size(); ++i) out.push_back({Index(i), 0});
  return out;
}

// By hand: a rectangle of 4 x 2 at height 1 has its mean in the middle; the squares of the four corners'
// distances are 4 * 2^2 along x and 4 * 1^2 along y.
TEST(PrincipalAxes, OfARectangleAreItsSidesAndItsNormal) {
  const Positions corners = {{0, 0, 1}, {4, 0, 1}, {4, 2, 1}, {0, 2, 1}};
  const PrincipalAxes found = principal_axes(corners, all_of(corners));
  EXPECT_TRUE(found.mean.isApprox(Eigen::Vector3d(2, 1, 1)));
  EXPECT_NEAR(found.axes.values[0], 0, 1e-12);
  EXPECT_NEAR(found.axes.values[1], 4, 1e-12);
  EXPECT_NEAR(found.axes.values[2], 16, 1e-12);
  EXPECT_NEAR(std::abs(found.axes.vectors.col(0)[2]), 1, 1e-12);
  EXPECT_NEAR(std::abs(found.axes.vectors.col(2)[0]), 1, 1e-12);
}

TEST(PrincipalAxes, PointsWithoutWeightHaveNoSay) {
  Positions points = {{0, 0, 1}, {4, 0, 1}, {4, 2, 1}, {0, 2, 1}};
  const PrincipalAxes without = principal_axes(points, all_of(points));
  points.emplace_back(7, 7, 7);
  const PrincipalAxes found =
      principal_axes(points, all_of(points), [](const Neighbor& q) { return q.index < 4 ? 1.0 : 0.0; });
  EXPECT_EQ(found.mean, without.mean);
  EXPECT_EQ(found.axes.values, without.axes.values);
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
