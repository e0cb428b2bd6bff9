#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/open3d/surface.h>

#include "pipeline/surface/surface_cleanup.h"
#include "pipeline/surface/topology.h"

using namespace rfsmooth;

namespace {

struct Oriented {
  Positions points, normals;
  double spacing = 0;
};

/// n points of the unit sphere along a spiral, nearly even.
Oriented sphere(std::size_t n) {
  Oriented cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * double(i) + 1) / double(n), r = std::sqrt(1 - z * z),
                 turn = 2.399963 * double(i);
    cloud.points.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  cloud.normals = cloud.points;
  cloud.spacing = std::sqrt(4 * M_PI / double(n));
  return cloud;
}

/// Its upper half: a bowl upside down, whose underside nobody scanned.
Oriented bowl(std::size_t n) {
  Oriented cloud = sphere(2 * n);
  cloud.points.resize(n);
  cloud.normals.resize(n);
  return cloud;
}

TEST(Poisson, ASphereComesOutClosedAndWhereItIs) {
  const Oriented cloud = sphere(2000);
  const auto made = open3d::poisson(cloud.points, cloud.normals, cloud.spacing, {});
  ASSERT_TRUE(made.ok());
  const Mesh& mesh = made.value();
  const Topology found = pipeline::topology(mesh.positions.size(), mesh.faces);
  EXPECT_TRUE(found.closed_manifold());
  EXPECT_EQ(found.components, 1u);
  EXPECT_EQ(found.genus, 0);
  ASSERT_GT(mesh.positions.size(), 100u);
  for (const Eigen::Vector3d& p : mesh.positions) EXPECT_NEAR(p.norm(), 1, 0.3 * cloud.spacing);
  double volume = 0;
  for (const auto& f : mesh.faces)
    volume += mesh.positions[f[0]].dot(mesh.positions[f[1]].cross(mesh.positions[f[2]])) / 6;
  EXPECT_NEAR(volume, 4.0 / 3 * M_PI, 0.1) << "faces look outward, as the normals do";
}

TEST(Poisson, WhatItInventsUnderABowlIsTrimmed) {
  const Oriented cloud = bowl(1000);
  const double reach = 4 * cloud.spacing;
  auto made = open3d::poisson(cloud.points, cloud.normals, cloud.spacing, {});
  ASSERT_TRUE(made.ok());
  Mesh& mesh = made.value();
  const auto farthest = [&] {
    double most = 0;
    const std::vector<Index> nearest = pipeline::nearest_points(mesh, cloud.points, {});
    EXPECT_EQ(nearest.size(), mesh.positions.size());
    for (std::size_t v = 0; v < nearest.size(); ++v)
      most = std::max(most, (mesh.positions[v] - cloud.points[nearest[v]]).norm());
    return most;
  };
  EXPECT_GT(farthest(), reach) << "Poisson goes on where there are no points";
  pipeline::trim_far_faces(mesh, cloud.points, reach, {});
  EXPECT_LE(farthest(), reach);
  // Every point still has surface near it.
  Mesh points;
  points.positions = cloud.points;
  const std::vector<Index> nearest = pipeline::nearest_points(points, mesh.positions, {});
  ASSERT_EQ(nearest.size(), cloud.points.size());
  for (std::size_t i = 0; i < nearest.size(); ++i)
    EXPECT_LE((cloud.points[i] - mesh.positions[nearest[i]]).norm(), 1.5 * cloud.spacing);
}

TEST(Poisson, SameBytesForAnyNumberOfThreads) {
  const Oriented cloud = sphere(3000);
  const auto with_threads = [&](int threads) {
    Context context;
    context.threads = threads;
    return open3d::poisson(cloud.points, cloud.normals, cloud.spacing, context).value();
  };
  const Mesh one = with_threads(1), four = with_threads(4);
  EXPECT_TRUE(one.positions == four.positions);
  EXPECT_TRUE(one.faces == four.faces);
}

TEST(BallPivoting, JoinsThePointsThemselves) {
  const Oriented cloud = sphere(1000);
  const auto made = open3d::ball_pivoting(cloud.points, cloud.normals, cloud.spacing, {});
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made.value().positions, cloud.points);
  const Topology found = pipeline::topology(cloud.points.size(), made.value().faces);
  EXPECT_EQ(found.components, 1u);
  EXPECT_EQ(found.crowded_edges, 0u);
  EXPECT_GT(found.faces, 1900u);
}

TEST(SurfaceMethods, WrongArgumentsAreTheCallersMistake) {
  const Oriented cloud = sphere(100);
  EXPECT_THROW(static_cast<void>(open3d::poisson(cloud.points, {}, 1, {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(open3d::ball_pivoting(cloud.points, cloud.normals, 0, {})),
               std::invalid_argument);
}

TEST(SurfaceMethods, CancellingIsAnErrorNotAnException) {
  const Positions points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const Positions normals(points.size(), {0, 0, 1});
  Context context;
  context.progress = [](std::string_view, double) { return false; };
  for (const auto& method : {open3d::poisson, open3d::ball_pivoting}) {
    const auto made = method(points, normals, 1, context);
    ASSERT_FALSE(made.ok());
    EXPECT_EQ(made.error().code, ErrorCode::cancelled);
  }
}

TEST(SurfaceMethods, AreCalledAsTheCommandCallsThem) {
  std::vector<std::string> names;
  for (const auto& method : open3d::surface_methods()) names.push_back(method.name);
  EXPECT_EQ(names, (std::vector<std::string>{"poisson", "ball-pivoting"}));
}

TEST(SurfaceMethods, ReportTheirNamesAsTheStage) {
  const Oriented cloud = sphere(200);
  for (const auto& method : open3d::surface_methods()) {
    std::vector<std::string> stages;
    Context context;
    context.progress = [&](std::string_view stage, double) {
      stages.emplace_back(stage);
      return true;
    };
    ASSERT_TRUE(method.run({cloud.points, cloud.normals, 0.2}, context).ok()) << method.name;
    EXPECT_EQ(stages, std::vector<std::string>{method.name});
  }
}

}  // namespace
