#include "rfsmooth/cgal/advancing_front.h"

#include <cmath>

#include <gtest/gtest.h>

#include "rfsmooth/clouds/sampling.h"
#include "rfsmooth/clouds/shapes.h"
#include "rfsmooth/pipeline/topology.h"

using namespace rfsmooth;

namespace {

Positions sheet(int side, double gap_from, double gap_to) {
  Positions points;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      if (x <= gap_from || x >= gap_to) points.emplace_back(x, y, 0.1 * std::sin(x) * std::cos(1.3 * y));
  return points;
}

TEST(AdvancingFront, VerticesAreThePointsInOrder) {
  const Positions points = sheet(10, 20, 0);
  const auto made = cgal::advancing_front(points, 0, {});
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made.value().positions, points);
  const pipeline::Topology found = pipeline::topology(points.size(), made.value().faces);
  EXPECT_TRUE(found.manifold());
  EXPECT_EQ(found.components, 1u);
  EXPECT_EQ(found.boundary_loops, 1u);
}

TEST(AdvancingFront, NoEdgeIsLongerThanTheLimit) {
  const Positions points = sheet(12, 4, 8);
  const auto made = cgal::advancing_front(points, 2.5, {});
  ASSERT_TRUE(made.ok());
  for (const auto& face : made.value().faces)
    for (int k = 0; k < 3; ++k)
      EXPECT_LE((points[face[std::size_t(k)]] - points[face[std::size_t((k + 1) % 3)]]).norm(), 2.5);
  EXPECT_EQ(pipeline::topology(points.size(), made.value().faces).components, 2u);
}

TEST(AdvancingFront, PointsOnALineHaveNoSurface) {
  Positions points;
  for (int i = 0; i < 20; ++i) points.emplace_back(i, 0, 0);
  const auto made = cgal::advancing_front(points, 0, {});
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, ErrorCode::no_usable_points);
}

}  // namespace
