#include <gtest/gtest.h>

#include <rfsmooth/mesh.h>

using namespace rfsmooth;

namespace {

Mesh two_triangles_and_a_tail() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 2, 0}, {9, 9, 9}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  mesh.loose_edges = {{2, 4}};
  rebuild_adjacency(mesh, {});
  return mesh;
}

std::vector<Index> row(const Adjacency& rows, Index i) {
  return {rows[i].begin(), rows[i].end()};
}

TEST(Mesh, AdjacencyIsFaceEdgesPlusLooseEdges) {
  const Mesh mesh = two_triangles_and_a_tail();
  EXPECT_EQ(row(mesh.one_ring, 0), (std::vector<Index>{1, 2, 3}));
  EXPECT_EQ(row(mesh.one_ring, 2), (std::vector<Index>{0, 1, 3, 4}));
  EXPECT_EQ(row(mesh.one_ring, 4), (std::vector<Index>{2}));
  EXPECT_EQ(mesh.one_ring.degree(5), 0u);
  EXPECT_EQ(mesh.edge_count(), 6u);
}

TEST(Mesh, VertexFacesListEveryCorner) {
  const Mesh mesh = two_triangles_and_a_tail();
  const Adjacency around = vertex_faces(mesh, {});
  EXPECT_EQ(row(around, 0), (std::vector<Index>{0, 1}));
  EXPECT_EQ(row(around, 3), (std::vector<Index>{1}));
  EXPECT_EQ(around.degree(4), 0u);
}

TEST(Mesh, OneRingIsThatOfTheKeptFaces) {
  Mesh mesh = two_triangles_and_a_tail();
  mesh.loose_edges.clear();
  const Adjacency around = vertex_faces(mesh, {}), all = one_ring(around, mesh.faces, {1, 1}, {});
  rebuild_adjacency(mesh, {});
  EXPECT_EQ(all.start, mesh.one_ring.start);
  EXPECT_EQ(all.items, mesh.one_ring.items);
  const Adjacency one = one_ring(around, mesh.faces, {0, 1}, {});
  EXPECT_EQ(row(one, 0), (std::vector<Index>{2, 3}));
  EXPECT_EQ(one.degree(1), 0u);
}

TEST(Mesh, JoinedGraphsHaveTheEdgesOfBoth) {
  const std::vector<Edge> all = {{0, 1}, {0, 3}, {1, 2}, {2, 3}, {2, 4}};
  const Adjacency graph =
      joined(make_adjacency(5, {all[1], all[4]}, {}), make_adjacency(5, {all[0], all[2], all[3]}, {}), {});
  const Adjacency at_once = make_adjacency(5, all, {});
  EXPECT_EQ(graph.start, at_once.start);
  EXPECT_EQ(graph.items, at_once.items);
  EXPECT_EQ(edges_of(graph, {}), all);
}

TEST(Mesh, MakeAdjacencyDropsDuplicatesAndSelfEdges) {
  const Adjacency rows = make_adjacency(3, {{0, 1}, {1, 0}, {2, 2}, {0, 1}}, {});
  EXPECT_EQ(rows.items.size(), 2u);
  EXPECT_EQ(rows.degree(2), 0u);
}

TEST(Mesh, CheckNamesWhatIsWrong) {
  Mesh mesh = two_triangles_and_a_tail();
  EXPECT_TRUE(check(mesh).empty());
  mesh.faces.push_back({0, 1, 5});
  EXPECT_FALSE(check(mesh).empty()) << "stale adjacency";
  mesh.faces.back() = {0, 0, 1};
  EXPECT_FALSE(check(mesh).empty()) << "repeated corner";
  mesh.faces.back() = {0, 1, 6};
  EXPECT_FALSE(check(mesh).empty()) << "corner out of range";
}

}  // namespace
