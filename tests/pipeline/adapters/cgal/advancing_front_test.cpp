#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/cgal/advancing_front.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "pipeline/surface/surface_cleanup.h"
#include "pipeline/surface/topology.h"

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
  const Topology found = pipeline::topology(points.size(), made.value().faces);
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

TEST(AdvancingFront, CancellingIsAnErrorNotAnException) {
  Context context;
  context.progress = [](std::string_view, double) { return false; };
  const auto made = cgal::advancing_front(sheet(12, 4, 8), {}, 0, context);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, ErrorCode::cancelled);
}

TEST(AdvancingFront, ReportsItsNameAsTheStage) {
  std::vector<std::string> stages;
  Context context;
  context.progress = [&](std::string_view stage, double) {
    stages.emplace_back(stage);
    return true;
  };
  ASSERT_TRUE(cgal::advancing_front(sheet(12, 4, 8), {}, 0, context).ok());
  EXPECT_EQ(stages, std::vector<std::string>{cgal::advancing_front_method().name});
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
  const Topology found = pipeline::topology(closed.value().positions.size(), closed.value().faces);
  EXPECT_TRUE(found.closed_manifold());
  EXPECT_EQ(found.components, 1u);
  EXPECT_EQ(found.genus, 1);
  double volume = 0;
  const Positions& at = closed.value().positions;
  for (const auto& f : closed.value().faces) volume += at[f[0]].dot(at[f[1]].cross(at[f[2]])) / 6;
  EXPECT_NEAR(volume, 2 * M_PI * M_PI * 0.4 * 0.4, 0.1) << "faces look outward";
}

/// The cube [-1, 1]^3 and on it a fin, 2 wide and 1.5 long, whose two sides noise has merged into one sheet.
void add_cube_with_fin(Positions& points, Positions& normals) {
  const auto cube = clouds::make_cube();
  for (const Eigen::Vector3d& p : clouds::sample(*cube, 6000, 1)) {
    points.push_back(p);
    normals.push_back(cube->normal(p));
  }
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> height(0.002, 0.012);
  Positions fin = clouds::sample(*clouds::make_wavy_sheet(), 1600, 2);
  for (std::size_t i = 0; i < fin.size(); ++i) {
    const double side = i % 2 == 0 ? 1 : -1;
    points.emplace_back(1.03 + 0.75 * (fin[i].x() + 1), fin[i].y(), side * height(engine));
    normals.emplace_back(0, 0, side);
  }
}

TEST(AdvancingFront, AMergedWallIsKeptWithBothItsSides) {
  Positions points, normals;
  add_cube_with_fin(points, normals);
  const double limit = 12 * clouds::mean_spacing(points);
  const auto made = cgal::advancing_front(points, normals, limit, {});
  ASSERT_TRUE(made.ok());
  Mesh mesh = made.value();
  pipeline::drop_specks(mesh, 100, {});
  const Topology found = pipeline::topology(mesh.positions.size(), mesh.faces);
  EXPECT_TRUE(found.closed_manifold());
  EXPECT_EQ(found.components, 1u);
  double area[2] = {0, 0};
  for (const auto& f : mesh.faces) {
    const auto& at = mesh.positions;
    const Eigen::Vector3d cross = (at[f[1]] - at[f[0]]).cross(at[f[2]] - at[f[0]]) / 2;
    if (at[f[0]].x() > 1.1 && at[f[1]].x() > 1.1 && at[f[2]].x() > 1.1)
      area[cross.z() > 0] += std::abs(cross.z());
  }
  for (const double side : area) EXPECT_NEAR(side, 2 * 1.43, 0.3);
}

TEST(AdvancingFront, WhatIsOpenStaysOpen) {
  struct Case {
    const char* name;
    double above;  // of z, where the unit sphere ends
  };
  const auto sphere = clouds::make_sphere();
  for (const Case& cut : {Case{"half", 0}, Case{"four fifths", 0.6}, Case{"all but a fortieth", 0.95}}) {
    Positions points;
    for (const Eigen::Vector3d& p : clouds::sample(*sphere, 8000, 4))
      if (p.z() < cut.above) points.push_back(p);
    const Positions normals = points;
    const double spacing = clouds::mean_spacing(points);
    clouds::add_noise(points, 0.1 * spacing, 5);
    const auto made = cgal::advancing_front(points, normals, 12 * spacing, {});
    ASSERT_TRUE(made.ok());
    EXPECT_GT(pipeline::topology(made.value().positions.size(), made.value().faces).boundary_edges, 10u)
        << cut.name;
  }
  Positions points, normals;  // a box without its lid
  const auto cube = clouds::make_cube();
  for (const Eigen::Vector3d& p : clouds::sample(*cube, 6000, 4))
    if (p.z() < 1) {
      points.push_back(p);
      normals.push_back(cube->normal(p));
    }
  const double spacing = clouds::mean_spacing(points);
  clouds::add_noise(points, 0.1 * spacing, 5);
  const auto made = cgal::advancing_front(points, normals, 12 * spacing, {});
  ASSERT_TRUE(made.ok());
  EXPECT_GT(pipeline::topology(made.value().positions.size(), made.value().faces).boundary_edges, 40u);
}

TEST(AdvancingFront, TheSurfaceDoesNotDependOnWhereItsNodesLieInMemory) {
  const auto torus = clouds::make_torus();
  Positions points = clouds::sample(torus->mesh(0.05), 4000, 3);
  clouds::add_noise(points, 1.5 * clouds::mean_spacing(points), 5);  // many candidates of one priority
  const auto first = cgal::advancing_front(points, {}, 0, {}).value().faces;
  std::mt19937_64 engine(7);
  for (int round = 0; round < 3; ++round) {
    std::vector<std::vector<char>> blocks(20000);  // every second one goes: gaps to fall into
    for (auto& block : blocks) block.resize(32 + engine() % 400);
    for (std::size_t k = 0; k < blocks.size(); k += 2) std::vector<char>().swap(blocks[k]);
    EXPECT_EQ(cgal::advancing_front(points, {}, 0, {}).value().faces, first);
  }
}

TEST(AdvancingFront, ASheetIsTurnedToItsNormalsAndStaysOpen) {
  const Positions points = sheet(15, 20, 0);
  for (const double side : {1.0, -1.0}) {
    const auto made = cgal::advancing_front(points, Positions(points.size(), {0, 0, side}), 0, {});
    ASSERT_TRUE(made.ok());
    EXPECT_GT(pipeline::topology(made.value().positions.size(), made.value().faces).boundary_edges, 40u);
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
