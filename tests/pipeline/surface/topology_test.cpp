#include "pipeline/surface/topology.h"

#include <gtest/gtest.h>

using namespace rfsmooth;
using namespace rfsmooth::pipeline;
using rfsmooth::Face;

namespace {

std::vector<Face> tetrahedron(Index a, Index b, Index c, Index d) {
  return {{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}};
}

/// A side x side grid of squares, closed in both directions: a torus.
std::vector<Face> torus(Index side) {
  std::vector<Face> faces;
  const auto at = [&](Index x, Index y) { return side * (y % side) + x % side; };
  for (Index y = 0; y < side; ++y)
    for (Index x = 0; x < side; ++x) {
      faces.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      faces.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return faces;
}

TEST(Topology, OfAClosedTetrahedron) {
  const Topology t = topology(9, tetrahedron(1, 3, 5, 7));
  EXPECT_EQ(t.vertices, 4u);
  EXPECT_EQ(t.edges, 6u);
  EXPECT_EQ(t.components, 1u);
  EXPECT_EQ(t.genus, 0);
  EXPECT_TRUE(t.closed_manifold());
}

TEST(Topology, ATorusHasOneHandleWithAndWithoutAHole) {
  std::vector<Face> faces = torus(5);
  EXPECT_TRUE(topology(25, faces).closed_manifold());
  EXPECT_EQ(topology(25, faces).genus, 1);
  faces.pop_back();
  const Topology t = topology(25, faces);
  EXPECT_EQ(t.boundary_edges, 3u);
  EXPECT_EQ(t.boundary_loops, 1u);
  EXPECT_EQ(t.genus, 1);
  EXPECT_TRUE(t.manifold());
  EXPECT_FALSE(t.closed_manifold());
}

TEST(Topology, PiecesAreCounted) {
  std::vector<Face> faces = tetrahedron(0, 1, 2, 3);
  for (const Face& f : tetrahedron(4, 5, 6, 7)) faces.push_back(f);
  const Topology t = topology(8, faces);
  EXPECT_EQ(t.components, 2u);
  EXPECT_EQ(t.genus, 0);
  EXPECT_TRUE(t.closed_manifold());
}

TEST(Topology, APinchedVertexACrowdedEdgeAndATurnedFaceAreNoManifold) {
  std::vector<Face> pinched = tetrahedron(0, 1, 2, 3);
  for (const Face& f : tetrahedron(0, 4, 5, 6)) pinched.push_back(f);
  EXPECT_EQ(topology(7, pinched).pinched_vertices, 1u);
  EXPECT_EQ(topology(7, pinched).components, 1u);
  EXPECT_FALSE(topology(7, pinched).manifold());

  const Topology crowded = topology(5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
  EXPECT_EQ(crowded.crowded_edges, 1u);
  EXPECT_FALSE(crowded.manifold());

  std::vector<Face> turned = tetrahedron(0, 1, 2, 3);
  std::swap(turned[0][0], turned[0][1]);
  EXPECT_EQ(topology(4, turned).disagreeing_edges, 3u);
  EXPECT_FALSE(topology(4, turned).manifold());
}

TEST(Topology, NothingIsNothing) {
  EXPECT_EQ(topology(3, {}).components, 0u);
  EXPECT_FALSE(topology(3, {}).closed_manifold());
}

}  // namespace
