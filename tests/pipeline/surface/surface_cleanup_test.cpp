#include "pipeline/surface/surface_cleanup.h"

#include <gtest/gtest.h>

using namespace rfsmooth;
using namespace rfsmooth::pipeline;

namespace {

/// A 20 x 20 grid of squares, each two faces.
Mesh grid() {
  Mesh mesh;
  for (int y = 0; y <= 20; ++y)
    for (int x = 0; x <= 20; ++x) mesh.positions.emplace_back(x, y, 0);
  const auto at = [](int x, int y) { return Index(21 * y + x); };
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) {
      mesh.faces.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.faces.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  rebuild_adjacency(mesh, {});
  return mesh;
}

TEST(TrimFarFaces, KeepsExactlyTheFacesWhoseCornersAreNearAPoint) {
  Mesh mesh = grid();
  Positions points;
  for (int y = 0; y <= 20; ++y)
    for (int x = 0; x <= 8; ++x) points.emplace_back(x, y, 0);  // the left part was scanned
  trim_far_faces(mesh, points, 1.5, {});
  EXPECT_EQ(mesh.faces.size(), 2u * 20 * 9) << "columns 0 to 9 have all corners within 1.5 of x <= 8";
  EXPECT_EQ(mesh.positions.size(), 21u * 10);
  EXPECT_TRUE(check(mesh).empty());
  for (const Eigen::Vector3d& p : mesh.positions) EXPECT_LE(p.x(), 9);
}

TEST(TrimFarFaces, NothingIsFar) {
  Mesh mesh = grid();
  const Mesh before = mesh;
  trim_far_faces(mesh, before.positions, 0, {});
  EXPECT_EQ(mesh.faces, before.faces);
  EXPECT_EQ(mesh.positions, before.positions);
}

TEST(TrimFarFaces, EverythingIsFar) {
  Mesh mesh = grid();
  trim_far_faces(mesh, {{1000, 0, 0}}, 2, {});
  EXPECT_TRUE(mesh.faces.empty());
  EXPECT_TRUE(mesh.positions.empty());
  EXPECT_TRUE(check(mesh).empty());
}

TEST(NearestPoints, AVertexTakesThePointItLiesOn) {
  const Mesh mesh = grid();
  const std::vector<Index> nearest = nearest_points(mesh, mesh.positions, {});
  ASSERT_EQ(nearest.size(), mesh.positions.size());
  for (Index v = 0; v < nearest.size(); ++v) EXPECT_EQ(nearest[v], v);
}

TEST(DropSpecks, SmallPiecesGoUnlessAllAreSmall) {
  Mesh mesh = grid();
  const auto n = Index(mesh.positions.size());
  for (int k = 0; k < 3; ++k) mesh.positions.emplace_back(100 + k, k * k, 0);
  mesh.faces.push_back({n, n + 1, n + 2});
  rebuild_adjacency(mesh, {});
  drop_specks(mesh, 2, {});
  EXPECT_EQ(mesh.faces, grid().faces);
  EXPECT_EQ(mesh.positions, grid().positions);
  drop_specks(mesh, 100000, {});
  EXPECT_EQ(mesh.faces, grid().faces);
}

}  // namespace
