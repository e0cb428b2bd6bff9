#include "smoothing/automatic/guide/stranded.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "rfs_mesh/search/neighbors.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

/// land_stranded, and whether the table still holds every point's nearest, nearer ones first.
std::size_t land(const Mesh& mesh, double most, Positions& guide) {
  const rfs_mesh::NeighborTable before = rfs_mesh::SpatialIndex(guide, {}).nearest(32, {});
  const Positions start = guide;
  const std::vector<double> of_each(guide.size(), most);
  const auto [found, near, tree] = land_stranded(mesh.positions, mesh.one_ring, of_each, guide, {});
  const rfs_mesh::SpatialIndex index(guide, {});
  const rfs_mesh::NeighborTable exact = index.nearest(32, {});
  for (std::size_t i = 0; i < guide.size(); ++i) {
    const auto moved = [&](Index j) { return guide[j] != start[j]; };
    const bool touched = moved(Index(i)) || std::any_of(before[i].begin(), before[i].end(), moved);
    for (std::size_t k = 0; k < 32; ++k) EXPECT_EQ(near[i][k], touched ? exact[i][k] : before[i][k]) << i;
  }
  return found;
}

TEST(Stranded, IslandsBesideTheSurfaceAreLanded) {
  Mesh mesh = support::icosphere(5);
  for (std::size_t i = 0; i < 2000; i += 100) mesh.positions[i] *= 1.1;
  Positions guide = mesh.positions;
  EXPECT_GE(land(mesh, 0.5, guide), 20u);
  for (std::size_t i = 0; i < 2000; i += 100) EXPECT_NEAR(guide[i].norm(), 1, 0.01);
  guide = mesh.positions;
  land(mesh, 0.05, guide);
  for (std::size_t i = 0; i < 2000; i += 100) EXPECT_EQ(guide[i], mesh.positions[i]) << "too far: a stray";
}

// As on the rings of a laser, where hardly a point has a face.
TEST(Stranded, AnEmptyRingIsNoSignWhereMostAreEmpty) {
  Mesh mesh = support::icosphere(4);
  const std::size_t n = mesh.positions.size();
  mesh.one_ring = rfsmooth::make_adjacency(n, {{0, 1}}, {});
  Positions guide = mesh.positions;
  EXPECT_EQ(land(mesh, 1, guide), 0U);
  EXPECT_EQ(guide, mesh.positions);
}

TEST(Stranded, DenseIslandsHalfWayBetweenTwoSheetsAreLandedOnOneOfThem) {
  // Two sheets sixteen apart, hexagonal, and between them clusters of fifteen points, denser than the sheets.
  Mesh mesh;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < 60; ++i)
      for (int j = 0; j < 60; ++j) mesh.positions.emplace_back(i + 0.5 * (j % 2), 0.866 * j, 16 * side);
  const std::size_t sheets = mesh.positions.size();
  for (int k = 0; k < 9; ++k)
    for (int m = 0; m < 15; ++m)
      mesh.positions.emplace_back(15 + 15 * (k % 3) + 0.4 * (m % 5), 13 + 13 * (k / 3) + 0.4 * (m / 5), 8.4);
  const std::size_t n = mesh.positions.size();
  std::vector<Edge> ring;
  for (Index i = 0; i < Index(n); ++i) ring.push_back({i, Index((i + 1) % n)});
  mesh.one_ring = rfsmooth::make_adjacency(n, ring, {});
  Positions guide = mesh.positions;
  land(mesh, 20, guide);
  for (std::size_t i = sheets; i < n; ++i)
    EXPECT_LT(std::min(std::abs(guide[i].z()), std::abs(guide[i].z() - 16)), 0.01) << i;
  for (std::size_t i = 0; i < sheets; ++i) EXPECT_NEAR(guide[i].z(), i < sheets / 2 ? 0 : 16, 0.01) << i;
}

TEST(Stranded, ASurfaceWithoutCornersHasNone) {
  for (const Mesh& mesh :
       {support::icosphere(4), support::torus(60, 30, 0.4), support::cylinder(60, 20, 0.1)}) {
    Positions guide = mesh.positions;
    EXPECT_EQ(land(mesh, 1, guide), 0u);
    EXPECT_EQ(guide, mesh.positions);
  }
}

TEST(Stranded, CornersOfAFlatSheetStayWhereTheyAre) {
  const Mesh mesh = support::grid(30, 30);
  Positions guide = mesh.positions;
  EXPECT_LE(land(mesh, 1, guide), 4u);
  EXPECT_LT(support::rms_distance(guide, mesh.positions), 1e-12);
}

TEST(Stranded, WhoHasNoNeighbourInTheMeshIsPutOntoThePlaneOfTheOthers) {
  Mesh mesh = support::grid(30, 30);
  Positions whole = mesh.positions;
  const std::size_t at_corners = land(mesh, 1, whole);
  const Index lone = 15 * 30 + 14;
  const auto has_it = [&](const Face& f) { return std::count(f.begin(), f.end(), lone) != 0; };
  mesh.faces.erase(std::remove_if(mesh.faces.begin(), mesh.faces.end(), has_it), mesh.faces.end());
  rebuild_adjacency(mesh, {});
  mesh.positions[lone].z() = 0.4;
  Positions guide = mesh.positions;
  EXPECT_EQ(land(mesh, 1, guide), at_corners + 1);
  EXPECT_LT(support::rms_distance(guide, whole), 1e-12);
}

TEST(Stranded, FewPointsAreLeftAlone) {
  Mesh mesh = support::grid(5, 5);
  mesh.positions[12].z() = 3;
  Positions guide = mesh.positions;
  const std::vector<double> most(guide.size(), 10);
  EXPECT_EQ(land_stranded(mesh.positions, mesh.one_ring, most, guide, {}).stranded, 0u);
  EXPECT_EQ(guide, mesh.positions);
}

}  // namespace
