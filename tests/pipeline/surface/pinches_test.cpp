#include "pipeline/surface/pinches.h"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/surface/topology.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using rfsmooth::Face;
using rfsmooth::Mesh;

namespace {

constexpr int kSide = 6;

/// The boundary of the full cells of a kSide^3 grid, outward, corners shared by all cells: it touches itself
/// at edges and vertices wherever cells meet so.
Mesh boundary_of(const std::vector<char>& full) {
  const auto cell = [&](int x, int y, int z) {
    const auto inside = [](int k) { return k >= 0 && k < kSide; };
    return inside(x) && inside(y) && inside(z) && full[std::size_t((z * kSide + y) * kSide + x)] != 0;
  };
  Mesh mesh;
  for (int z = 0; z <= kSide; ++z)
    for (int y = 0; y <= kSide; ++y)
      for (int x = 0; x <= kSide; ++x) mesh.positions.emplace_back(x, y, z);
  const auto corner = [](const std::array<int, 3>& p) {
    return Index((p[2] * (kSide + 1) + p[1]) * (kSide + 1) + p[0]);
  };
  for (int z = 0; z < kSide; ++z)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        for (int axis = 0; cell(x, y, z) && axis < 3; ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> next = {x, y, z};
            next[std::size_t(axis)] += side == 0 ? -1 : 1;
            if (cell(next[0], next[1], next[2])) continue;
            const auto u = std::size_t((axis + 1) % 3), v = std::size_t((axis + 2) % 3);
            std::array<std::array<int, 3>, 4> square;
            square.fill({x, y, z});
            for (auto& p : square) p[std::size_t(axis)] += side;
            ++square[1][u], ++square[2][u], ++square[2][v], ++square[3][v];
            const Index a = corner(square[0]), b = corner(square[1]), c = corner(square[2]),
                        d = corner(square[3]);
            if (side == 1) {
              mesh.faces.push_back({a, b, c});
              mesh.faces.push_back({a, c, d});
            } else {
              mesh.faces.push_back({a, c, b});
              mesh.faces.push_back({a, d, c});
            }
          }
  rebuild_adjacency(mesh, {});
  return mesh;
}

Mesh boundary_of_cells(const std::vector<std::array<int, 3>>& cells) {
  std::vector<char> full(kSide * kSide * kSide, 0);
  for (const auto& c : cells) full[std::size_t((c[2] * kSide + c[1]) * kSide + c[0])] = 1;
  return boundary_of(full);
}

TEST(Pinches, ManifoldsStayAsTheyAre) {
  for (Mesh mesh : {support::icosphere(2), support::torus(12, 8, 0.4), support::grid(5, 4),
                    support::cylinder(8, 3, 0.2)}) {
    const Mesh before = mesh;
    EXPECT_EQ(pipeline::part_pinches(mesh, {}), 0u);
    EXPECT_EQ(mesh.faces, before.faces);
    EXPECT_EQ(mesh.positions, before.positions);
  }
}

TEST(Pinches, CubesThatTouchComeApart) {
  struct Case {
    std::vector<std::array<int, 3>> cells;
    std::size_t copies;
  };
  for (const Case& touching : {Case{{{1, 1, 1}, {2, 2, 1}}, 2},     // along an edge
                               Case{{{1, 1, 1}, {2, 2, 2}}, 1}}) {  // at a corner
    Mesh mesh = boundary_of_cells(touching.cells);
    ASSERT_FALSE(pipeline::topology(mesh.positions.size(), mesh.faces).manifold());
    EXPECT_EQ(pipeline::part_pinches(mesh, {}), touching.copies);
    const Topology found = pipeline::topology(mesh.positions.size(), mesh.faces);
    EXPECT_TRUE(found.closed_manifold());
    EXPECT_EQ(found.components, 2u);
  }
}

TEST(Pinches, ARingThatTouchesItselfAlongAnEdgeStaysOnePiece) {
  // From one side of the edge the way leads round to the other.
  Mesh mesh = boundary_of_cells({{1, 1, 1}, {2, 2, 1}, {1, 1, 2}, {1, 2, 2}, {2, 2, 2}});
  ASSERT_FALSE(pipeline::topology(mesh.positions.size(), mesh.faces).manifold());
  EXPECT_GT(pipeline::part_pinches(mesh, {}), 0u);
  const Topology found = pipeline::topology(mesh.positions.size(), mesh.faces);
  EXPECT_TRUE(found.closed_manifold());
  EXPECT_EQ(found.components, 1u);
}

TEST(Pinches, AnyHeapOfCubesBecomesAManifoldOfTheSameFaces) {
  std::mt19937_64 engine(3);
  for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9})
    for (int round = 0; round < 20; ++round) {
      std::vector<char> full(kSide * kSide * kSide);
      for (char& cell : full) cell = std::bernoulli_distribution(share)(engine) ? 1 : 0;
      Mesh mesh = boundary_of(full);
      const Mesh before = mesh;
      ASSERT_FALSE(before.faces.empty());
      const std::size_t copies = pipeline::part_pinches(mesh, {});
      ASSERT_EQ(mesh.positions.size(), before.positions.size() + copies);
      ASSERT_EQ(mesh.faces.size(), before.faces.size());
      for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k)
          ASSERT_EQ(mesh.positions[mesh.faces[f][k]], before.positions[before.faces[f][k]]);
      const Topology found = pipeline::topology(mesh.positions.size(), mesh.faces);
      EXPECT_TRUE(found.closed_manifold()) << share << ", round " << round << ": " << found.crowded_edges
                                           << " crowded, " << found.pinched_vertices << " pinched";
    }
}

TEST(Pinches, FacesThatDisagreeComeApart) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 1, 3}};
  rebuild_adjacency(mesh, {});
  EXPECT_EQ(pipeline::part_pinches(mesh, {}), 2u);
  EXPECT_TRUE(pipeline::topology(mesh.positions.size(), mesh.faces).manifold());
}

}  // namespace
