#include "rfsmooth/cgal/advancing_front.h"

#include <cmath>

#include <Eigen/Geometry>
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
  const auto made = cgal::advancing_front(points, {}, 0, {});
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made.value().positions, points);
  const pipeline::Topology found = pipeline::topology(points.size(), made.value().faces);
  EXPECT_TRUE(found.manifold());
  EXPECT_EQ(found.components, 1u);
  EXPECT_EQ(found.boundary_loops, 1u);
}

TEST(AdvancingFront, NoEdgeIsLongerThanTheLimit) {
  const Positions points = sheet(12, 4, 8);
  const auto made = cgal::advancing_front(points, {}, 2.5, {});
  ASSERT_TRUE(made.ok());
  for (const auto& face : made.value().faces)
    for (int k = 0; k < 3; ++k)
      EXPECT_LE((points[face[std::size_t(k)]] - points[face[std::size_t((k + 1) % 3)]]).norm(), 2.5);
  EXPECT_EQ(pipeline::topology(points.size(), made.value().faces).components, 2u);
}

TEST(AdvancingFront, PointsOnALineHaveNoSurface) {
  Positions points;
  for (int i = 0; i < 20; ++i) points.emplace_back(i, 0, 0);
  const auto made = cgal::advancing_front(points, {}, 0, {});
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, ErrorCode::no_usable_points);
}

TEST(AdvancingFront, AFrontThatAllButBoundsASolidIsClosed) {
  const auto torus = clouds::make_torus();
  Positions points = clouds::sample(torus->mesh(0.05), 3000, 3);
  const double spacing = clouds::mean_spacing(points);
  clouds::add_noise(points, 0.3 * spacing, 5);
  Positions normals;
  for (const Eigen::Vector3d& p : points) normals.push_back(torus->normal(p));

  const auto bare = cgal::advancing_front(points, {}, 0, {});
  ASSERT_TRUE(bare.ok());
  EXPECT_GT(pipeline::topology(points.size(), bare.value().faces).boundary_edges, 0u) << "noise leaves holes";
  const auto closed = cgal::advancing_front(points, normals, 0, {});
  ASSERT_TRUE(closed.ok());
  const pipeline::Topology found = pipeline::topology(points.size(), closed.value().faces);
  EXPECT_TRUE(found.closed_manifold());
  EXPECT_EQ(found.components, 1u);
  EXPECT_EQ(found.genus, 1);
  double volume = 0;
  for (const auto& f : closed.value().faces) volume += points[f[0]].dot(points[f[1]].cross(points[f[2]])) / 6;
  EXPECT_NEAR(volume, 2 * M_PI * M_PI * 0.4 * 0.4, 0.1) << "faces look outward";
}

TEST(AdvancingFront, ASheetIsTurnedToItsNormalsAndStaysOpen) {
  const Positions points = sheet(15, 20, 0);
  for (const double side : {1.0, -1.0}) {
    const auto made = cgal::advancing_front(points, Positions(points.size(), {0, 0, side}), 0, {});
    ASSERT_TRUE(made.ok());
    EXPECT_GT(pipeline::topology(points.size(), made.value().faces).boundary_edges, 40u);
    for (const auto& f : made.value().faces)
      EXPECT_GT(side * (points[f[1]] - points[f[0]]).cross(points[f[2]] - points[f[0]]).z(), 0);
  }
}

TEST(AdvancingFront, TheUnitDoesNotMatter) {
  const Positions points = sheet(10, 20, 0);
  Positions small = points;
  for (Eigen::Vector3d& p : small) p *= std::ldexp(1.0, -40);
  EXPECT_EQ(cgal::advancing_front(points, {}, 0, {}).value().faces,
            cgal::advancing_front(small, {}, 0, {}).value().faces);
}

}  // namespace
