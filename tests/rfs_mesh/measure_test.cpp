#include "rfs_mesh/measure.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/edge_census.h"

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

/// The unit right tetrahedron, faces outward.
Mesh tetrahedron() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  rebuild_adjacency(mesh, {});
  return mesh;
}

TEST(Measure, TetrahedronByHand) {
  const Mesh mesh = tetrahedron();
  EXPECT_NEAR(signed_volume(mesh, {}), 1.0 / 6, 1e-15);
  EXPECT_NEAR(surface_area(mesh, {}), 1.5 + std::sqrt(3.0) / 2, 1e-15);
  EXPECT_NEAR(mean_edge_length(mesh, {}), (1 + std::sqrt(2.0)) / 2, 1e-15);
  // Three right angles, and three between a coordinate plane and x + y + z = 1.
  const test::EdgeCensus census = test::edge_census(mesh);
  EXPECT_NEAR(census.dihedral_angle_sum, 1.5 * M_PI + 3 * std::acos(1 / std::sqrt(3.0)), 1e-14);
  EXPECT_EQ(census.inner, 6u);
  EXPECT_EQ(census.rim + census.loose + census.crowded + census.faceless, 0u);
}

TEST(Measure, VolumeDoesNotDependOnTheOriginAndFlipsWithTheFaces) {
  Mesh mesh = tetrahedron();
  for (auto& p : mesh.positions) p += Eigen::Vector3d(1e6, -2e6, 3e6);
  EXPECT_NEAR(signed_volume(mesh, {}), 1.0 / 6, 1e-8);
  for (Face& f : mesh.faces) std::swap(f[0], f[1]);
  EXPECT_NEAR(signed_volume(mesh, {}), -1.0 / 6, 1e-8);
}

TEST(Measure, NormalsAreUnitAndOutward) {
  const Mesh mesh = tetrahedron();
  const Eigen::Vector3d centre(0.25, 0.25, 0.25);
  const Positions normals = vertex_normals(mesh, {});
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_NEAR(normals[v].norm(), 1, 1e-15);
    EXPECT_GT(normals[v].dot(mesh.positions[v] - centre), 0);
  }
}

TEST(Measure, DihedralAngleGoesFromFoldedToFlat) {
  const Eigen::Vector3d p(0, 0, 0), q(0, 0, 1), r(1, 0, 0.3);
  for (double angle = 0.1; angle < M_PI; angle += 0.3)
    EXPECT_NEAR(dihedral_angle(p, q, r, {std::cos(angle), std::sin(angle), 0.8}), angle, 1e-14);
  EXPECT_NEAR(dihedral_angle(p, q, r, {-2, 0, 0.1}), M_PI, 1e-15);
  EXPECT_EQ(dihedral_angle(p, p, r, q), 0) << "no edge, no angle";
}

TEST(Measure, QualityIsOneForEquilateralZeroForDegenerateAndScaleFree) {
  EXPECT_NEAR(face_quality({1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1, 1e-15);
  EXPECT_EQ(face_quality({0, 0, 0}, {1, 1, 1}, {2, 2, 2}), 0);
  EXPECT_EQ(face_quality({1, 1, 1}, {1, 1, 1}, {1, 1, 1}), 0);
  const Eigen::Vector3d a(0, 0, 0), b(3, 0, 0), c(1, 1, 0);
  EXPECT_NEAR(face_quality(a, b, c), face_quality(1e-9 * a, 1e-9 * b, 1e-9 * c), 1e-12);
}

TEST(Measure, AnEmptyMeshMeasuresNothing) {
  const Mesh mesh;
  EXPECT_EQ(signed_volume(mesh, {}), 0);
  EXPECT_EQ(mean_edge_length(mesh, {}), 0);
}

}  // namespace
