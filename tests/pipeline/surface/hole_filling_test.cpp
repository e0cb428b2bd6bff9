#include "pipeline/surface/hole_filling.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "pipeline/surface/topology.h"

using namespace rfsmooth;
using namespace rfsmooth::pipeline;

namespace {

/// A 20 x 20 grid of squares, each two faces that look up, without the squares that `missing` names.
Mesh grid(const std::function<bool(int, int)>& missing) {
  Mesh mesh;
  for (int y = 0; y <= 20; ++y)
    for (int x = 0; x <= 20; ++x) mesh.positions.emplace_back(x, y, 0.1 * std::sin(x + 2.0 * y));
  const auto at = [](int x, int y) { return Index(21 * y + x); };
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) {
      if (missing(x, y)) continue;
      mesh.faces.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.faces.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  rebuild_adjacency(mesh, {});
  return mesh;
}

TEST(FillHoles, ASlitIsClosedAndTheRimOfTheSheetIsNot) {
  Mesh mesh = grid([](int x, int y) { return y == 7 && x > 4 && x < 15; });
  EXPECT_EQ(topology(mesh.positions.size(), mesh.faces).boundary_loops, 2u);
  EXPECT_EQ(fill_holes(mesh, 2, {}), 1u);
  const Topology after = topology(mesh.positions.size(), mesh.faces);
  EXPECT_EQ(after.boundary_loops, 1u);
  EXPECT_EQ(after.boundary_edges, 80u);
  EXPECT_TRUE(after.manifold()) << "new faces look up as their neighbours do";
  EXPECT_EQ(after.faces, 2u * 20 * 20) << "the slit is full again";
  EXPECT_TRUE(check(mesh).empty());
}

TEST(FillHoles, AWideGapStaysOpen) {
  const auto gap = [](int x, int y) { return x > 5 && x < 12 && y > 5 && y < 12; };
  Mesh mesh = grid(gap);
  const auto before = mesh.faces;
  EXPECT_EQ(fill_holes(mesh, 4, {}), 0u);
  EXPECT_EQ(mesh.faces, before);
  EXPECT_EQ(fill_holes(mesh, 9, {}), 1u);
  EXPECT_EQ(topology(mesh.positions.size(), mesh.faces).boundary_loops, 1u) << "the rim only";
  ASSERT_EQ(mesh.faces.size(), before.size() + 22) << "a loop of 24 edges takes two faces fewer";
  for (std::size_t f = before.size(); f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LE((mesh.positions[mesh.faces[f][k]] - mesh.positions[mesh.faces[f][(k + 1) % 3]]).norm(), 9);
}

TEST(FillHoles, NoEdgeOfTheSurfaceIsUsedAgain) {
  // A square hole whose one diagonal is an edge already takes the other one; with both taken it stays open.
  const Index a = 21 * 9 + 9, b = a + 1, c = 21 * 10 + 10, d = c - 1;
  for (const bool both : {false, true}) {
    Mesh mesh = grid([](int x, int y) { return x == 9 && y == 9; });
    mesh.loose_edges = {{a, c}};
    if (both) mesh.loose_edges.push_back({b, d});
    rebuild_adjacency(mesh, {});
    const std::size_t before = mesh.faces.size();
    EXPECT_EQ(fill_holes(mesh, 2, {}), both ? 0u : 1u);
    ASSERT_EQ(mesh.faces.size(), before + (both ? 0 : 2));
    EXPECT_TRUE(check(mesh).empty());
    for (std::size_t f = before; f < mesh.faces.size(); ++f)
      EXPECT_FALSE(std::count(mesh.faces[f].begin(), mesh.faces[f].end(), a) == 1 &&
                   std::count(mesh.faces[f].begin(), mesh.faces[f].end(), c) == 1);
  }
}

TEST(FillHoles, ARimThatPassesAVertexTwiceIsLeftAlone) {
  Mesh mesh = grid([](int x, int y) { return x == 9 && y == 9; });
  const Index a = 21 * 9 + 9, c = 21 * 10 + 10;
  mesh.positions.emplace_back(9.5, 9.5, 5);
  mesh.faces.push_back({a, c, Index(mesh.positions.size() - 1)});  // a flap on the diagonal
  rebuild_adjacency(mesh, {});
  const auto before = mesh.faces;
  EXPECT_EQ(fill_holes(mesh, 2, {}), 0u);
  EXPECT_EQ(mesh.faces, before);
}

TEST(FillHoles, AnOpenTetrahedronIsClosed) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}};
  rebuild_adjacency(mesh, {});
  EXPECT_EQ(fill_holes(mesh, 1.5, {}), 1u);
  EXPECT_TRUE(topology(4, mesh.faces).closed_manifold());
}

TEST(FillHoles, TheOutlineOfANarrowPieceStaysOpen) {
  // Every chord across the ribbon is short enough: filled, its outline would be a second sheet over the
  // first.
  const auto outside = [](int x, int y) { return x >= 5 || y >= 18; };
  Mesh mesh = grid([&](int x, int y) { return outside(x, y) || (x == 2 && y == 9); });
  const std::size_t before = mesh.faces.size();
  EXPECT_EQ(fill_holes(mesh, 8, {}), 1u) << "the hole within it is one";
  EXPECT_EQ(mesh.faces.size(), before + 2);
  EXPECT_EQ(topology(mesh.positions.size(), mesh.faces).boundary_loops, 1u);

  Mesh both = grid(outside);
  const Mesh lonely = both;
  const Index n = Index(both.positions.size());
  for (const Eigen::Vector3d& p : lonely.positions)
    both.positions.push_back(10 * (p + Eigen::Vector3d(99, 0, 0)));
  for (const Face& f : lonely.faces) both.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
  rebuild_adjacency(both, {});
  EXPECT_EQ(fill_holes(both, 8, {}), 0u) << "another piece, however large, is no reason";
}

TEST(FillHoles, AHalfSphereGetsItsLid) {
  // Rings of 24 vertices from the equator up, and the pole.
  constexpr int kAround = 24, kRings = 6;
  Mesh mesh;
  const double right_angle = std::acos(0.0);
  for (int ring = 0; ring < kRings; ++ring)
    for (int k = 0; k < kAround; ++k) {
      const double up = right_angle * ring / kRings, turn = 4 * right_angle * k / kAround;
      mesh.positions.emplace_back(std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up));
    }
  mesh.positions.emplace_back(0, 0, 1);
  const auto at = [](int ring, int k) {
    return ring == kRings ? Index(kRings * kAround) : Index(ring * kAround + k % kAround);
  };
  for (int ring = 0; ring < kRings; ++ring)
    for (int k = 0; k < kAround; ++k) {
      mesh.faces.push_back({at(ring, k), at(ring, k + 1), at(ring + 1, k)});
      if (ring + 1 < kRings) mesh.faces.push_back({at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)});
    }
  rebuild_adjacency(mesh, {});
  EXPECT_EQ(fill_holes(mesh, 3, {}), 1u);
  EXPECT_TRUE(topology(mesh.positions.size(), mesh.faces).closed_manifold());
}

}  // namespace
