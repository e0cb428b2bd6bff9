#include "smoothing/modifiers/preserve.h"

#include <cmath>

#include <gtest/gtest.h>

#include "rfs_mesh/measure.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

FlowOptions laplacian(Preserve preserve) {
  LaplacianOptions ten;
  ten.iterations = 10;
  FlowOptions o{ten};
  o.modifiers.preserve = preserve;
  return o;
}

TEST(Preserve, VolumeIsKeptAndItIsAScalingAboutTheCentroid) {
  Mesh mesh = support::icosphere(3);
  support::add_noise(mesh, 0.03, 1);
  Mesh plain = mesh;
  const double volume = support::enclosed_volume(mesh);
  FlowOptions o = laplacian(Preserve::volume);
  iterations(o.flow) = 1;
  ASSERT_TRUE(smooth(mesh, o, {}).ok());
  EXPECT_NEAR(support::enclosed_volume(mesh) / volume, 1, 1e-13);
  o.modifiers.preserve = Preserve::none;
  ASSERT_TRUE(smooth(plain, o, {}).ok());
  const double beta = std::cbrt(volume / support::enclosed_volume(plain));
  Vector3d centre = Vector3d::Zero();
  for (const Vector3d& p : plain.positions) centre += p / double(plain.positions.size());
  for (std::size_t i = 0; i < plain.positions.size(); ++i)
    EXPECT_LT((mesh.positions[i] - centre - beta * (plain.positions[i] - centre)).norm(), 1e-12);
}

TEST(Preserve, FacesThatDisagreeAreOrientedFirst) {
  Mesh mesh = support::torus(24, 12, 0.4);
  support::add_noise(mesh, 0.02, 1);
  Mesh mixed = mesh;
  for (std::size_t f = 0; f < mixed.faces.size(); f += 3) std::swap(mixed.faces[f][0], mixed.faces[f][1]);
  ASSERT_TRUE(smooth(mesh, laplacian(Preserve::volume), {}).ok());
  ASSERT_TRUE(smooth(mixed, laplacian(Preserve::volume), {}).ok());
  EXPECT_LT(support::rms_distance(mesh.positions, mixed.positions), 1e-12);
}

TEST(Preserve, VolumeOfAnOpenMeshIsRefusedWithAReason) {
  Mesh sheet = support::grid(5, 5);
  const auto result = smooth(sheet, laplacian(Preserve::volume), {});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_NE(result.error().message.find("closed"), std::string::npos);
}

TEST(Preserve, AreaOfAnOpenMesh) {
  Mesh mesh = support::cylinder(24, 8, 0.25);
  support::add_noise(mesh, 0.02, 1);
  const double area = rfs_mesh::surface_area(mesh, {});
  ASSERT_TRUE(smooth(mesh, laplacian(Preserve::area), {}).ok());
  EXPECT_NEAR(rfs_mesh::surface_area(mesh, {}) / area, 1, 1e-12);
}

TEST(Preserve, VolumeUnderAHeightField) {
  Mesh mesh = support::grid(12, 10);
  for (Vector3d& p : mesh.positions) p.z() = 5 + std::sin(p.x()) * std::cos(0.7 * p.y());
  FlowOptions o = laplacian(Preserve::height_field);
  o.modifiers.boundary = Boundary::fixed;
  const auto under = [](const Mesh& m) {
    double volume = 0;
    for (const Face& f : m.faces) {
      const Vector3d &a = m.positions[f[0]], &b = m.positions[f[1]], &c = m.positions[f[2]];
      volume +=
          0.5 * std::abs((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x()) * (a.z() + b.z() + c.z()) / 3;
    }
    return volume;
  };
  const double volume = under(mesh);
  const Mesh before = mesh;
  ASSERT_TRUE(smooth(mesh, o, {}).ok());
  EXPECT_NEAR(under(mesh) / volume, 1, 1e-12);
  EXPECT_EQ(mesh.positions[0], before.positions[0]) << "fixed vertices stay, unlike the paper's scaling";
}

TEST(Preserve, ConstrainedVerticesStayConstrained) {
  Mesh mesh = support::icosphere(3);
  support::add_noise(mesh, 0.03, 1);
  const Positions before = mesh.positions;
  const double volume = support::enclosed_volume(mesh);
  ASSERT_TRUE(smooth(mesh, laplacian(Preserve::volume), {},
                     {{{5, HardConstraint::Kind::fixed, Vector3d::Zero()}}, {}})
                  .ok());
  EXPECT_EQ(mesh.positions[5], before[5]);
  EXPECT_NEAR(support::enclosed_volume(mesh) / volume, 1, 1e-12);
}

TEST(Preserve, WhatTheRulesPreventIsAnErrorThatNamesTheReason) {
  Mesh sheet = support::grid(9, 9);
  support::add_noise(sheet, 0.1, 2);
  const Positions before = sheet.positions;
  FlowOptions o = laplacian(Preserve::area);
  o.modifiers.boundary = Boundary::fixed;  // a sheet in a fixed frame loses the area of its waves for good
  const auto run = smooth(sheet, o, {});
  ASSERT_FALSE(run.ok());
  EXPECT_EQ(run.error().code, ErrorCode::usage);
  for (const char* part : {"area", "49 of 81 vertices", "boundary", "constraints"})
    EXPECT_NE(run.error().message.find(part), std::string::npos) << part << " in " << run.error().message;
  EXPECT_EQ(sheet.positions, before);
}

}  // namespace
