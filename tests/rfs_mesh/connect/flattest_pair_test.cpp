#include "rfs_mesh/connect/flattest_pair.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "rfs_mesh/measure.h"
#include "tests/support/edge_census.h"
#include "tests/support/shapes.h"
#include "tests/support/test_ground.h"

namespace rfsmooth::rfs_mesh {
namespace {

constexpr double kSameFold = 10;  // degrees, the default

/// The umbrellas of a mesh's own faces; the faces at a vertex must be one fan.
std::vector<Umbrella> umbrellas_of(const Mesh& mesh) {
  std::vector<std::map<Index, Index>> after(mesh.positions.size()), before(mesh.positions.size());
  for (const Face& f : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      after[f[k]][f[(k + 1) % 3]] = f[(k + 2) % 3];
      before[f[k]][f[(k + 2) % 3]] = f[(k + 1) % 3];
    }
  std::vector<Umbrella> umbrellas(mesh.positions.size());
  for (std::size_t v = 0; v < umbrellas.size(); ++v) {
    if (after[v].empty()) continue;
    Index rib = after[v].begin()->first;
    for (std::size_t k = 0; k < after[v].size() && before[v].count(rib) != 0; ++k) rib = before[v][rib];
    Umbrella& u = umbrellas[v];
    for (std::size_t k = 0; k < after[v].size(); ++k, rib = after[v][rib]) {
      u.ribs[u.count] = rib;
      u.faces = std::uint16_t(u.faces | 1u << u.count++);
    }
    if (rib != u.ribs[0]) u.ribs[u.count++] = rib;  // open: the last rib spans nothing
  }
  return umbrellas;
}

/// Corners in ascending order: a face whichever way it is wound and wherever it begins.
Face unordered(Face f) {
  std::sort(f.begin(), f.end());
  return f;
}

std::vector<Face> all_unordered(const std::vector<Face>& faces) {
  std::vector<Face> all;
  for (const Face& f : faces) all.push_back(unordered(f));
  std::sort(all.begin(), all.end());
  return all;
}

Mesh mesh_of(Positions positions, std::vector<Face> faces) {
  Mesh mesh;
  mesh.positions = std::move(positions);
  mesh.faces = std::move(faces);
  rebuild_adjacency(mesh, {});
  return mesh;
}

Mesh eight_faces() {
  return mesh_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                 {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

Mesh box() {
  return mesh_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
                 {{0, 2, 1},
                  {0, 3, 2},
                  {4, 5, 6},
                  {4, 6, 7},
                  {0, 1, 5},
                  {0, 5, 4},
                  {1, 2, 6},
                  {1, 6, 5},
                  {2, 3, 7},
                  {2, 7, 6},
                  {3, 0, 4},
                  {3, 4, 7}});
}

/// Four faces of a box's upper corner: open.
Mesh box_without_bottom() {
  Mesh mesh = box();
  mesh.faces.erase(mesh.faces.begin(), mesh.faces.begin() + 2);
  rebuild_adjacency(mesh, {});
  return mesh;
}

TEST(ProposedFaces, OfAMeshesOwnUmbrellasAreItsFacesWithThreeVotesEach) {
  for (const Mesh& mesh : {eight_faces(), box(), box_without_bottom()}) {
    const ProposedFaces proposed = proposed_faces(umbrellas_of(mesh), {});
    EXPECT_EQ(all_unordered(proposed.faces), all_unordered(mesh.faces));
    EXPECT_EQ(proposed.votes, std::vector<std::uint8_t>(mesh.faces.size(), 3));
    const FlattestPairs kept = keep_flattest_pairs(mesh.positions, proposed, kSameFold, {});
    EXPECT_EQ(kept.faces, proposed.faces) << "no edge has more than two";
    Mesh again = mesh;
    again.faces = kept.faces;
    rebuild_adjacency(again, {});
    EXPECT_EQ(kept.one_ring.start, again.one_ring.start);
    EXPECT_EQ(kept.one_ring.items, again.one_ring.items);
  }
}

TEST(ProposedFaces, OfOneUmbrellaHaveOneVote) {
  std::vector<Umbrella> umbrellas = umbrellas_of(eight_faces());
  for (std::size_t v = 0; v < umbrellas.size(); ++v)
    if (v != 4) umbrellas[v] = {};
  const ProposedFaces proposed = proposed_faces(umbrellas, {});
  EXPECT_EQ(proposed.faces.size(), 4u);
  EXPECT_EQ(proposed.votes, std::vector<std::uint8_t>(4, 1));
}

class FacesOfShape : public testing::TestWithParam<test::Shape> {
 protected:
  FacesOfShape() : ground_(test::random_points(GetParam(), 2000, 3)) {
    umbrellas_ = open_umbrellas(ground_.terrain(), ground_.sdg().graph, {}, {});
    proposed_ = proposed_faces(umbrellas_, {});
  }
  test::TestGround ground_;
  std::vector<Umbrella> umbrellas_;
  ProposedFaces proposed_;
};

TEST_P(FacesOfShape, AreThoseThatUmbrellasSpanWithTheirVotes) {
  std::map<Face, int> expected;
  for (Index v = 0; v < umbrellas_.size(); ++v)
    for (int k = 0; k < umbrellas_[v].count; ++k)
      if (umbrellas_[v].spans(k))
        ++expected[unordered({v, umbrellas_[v].ribs[std::size_t(k)], umbrellas_[v].next(k)})];
  ASSERT_GT(expected.size(), umbrellas_.size());
  ASSERT_EQ(proposed_.faces.size(), expected.size());
  ASSERT_EQ(proposed_.votes.size(), expected.size());
  for (std::size_t f = 0; f < proposed_.faces.size(); ++f)
    EXPECT_EQ(int(proposed_.votes[f]), expected[unordered(proposed_.faces[f])]);
}

/// How good a pair at an edge is: fewer steps of fold, then more votes, then more quality.
struct PairMerit {
  int fold, votes;
  double quality;
};

/// Whether x is better than y, by more than rounding could turn round.
bool surely_better(const PairMerit& x, const PairMerit& y) {
  if (x.fold != y.fold) return x.fold < y.fold;
  if (x.votes != y.votes) return x.votes > y.votes;
  return x.quality > y.quality + 1e-6;
}

TEST_P(FacesOfShape, FacesOfTheFlattestPairAtAllTheirEdgesStayAndNoEdgeHasMoreThanTwo) {
  const Positions& at = ground_.points;
  const FlattestPairs kept = keep_flattest_pairs(at, proposed_, kSameFold, {});
  std::map<Edge, std::vector<std::size_t>> faces_at;
  for (std::size_t f = 0; f < proposed_.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = proposed_.faces[f][k], b = proposed_.faces[f][(k + 1) % 3];
      faces_at[{std::min(a, b), std::max(a, b)}].push_back(f);
    }
  std::vector<char> wins(proposed_.faces.size(), 1);  // at all of its edges
  std::size_t crowded = 0;
  for (const auto& [edge, faces] : faces_at) {
    if (faces.size() <= 2) continue;
    ++crowded;
    const auto opposite = [&, a = edge[0], b = edge[1]](std::size_t f) {
      return at[proposed_.faces[f][0] ^ proposed_.faces[f][1] ^ proposed_.faces[f][2] ^ a ^ b];
    };
    const auto merit = [&, a = edge[0], b = edge[1]](std::size_t x, std::size_t y) {
      const auto quality = [&](std::size_t f) {
        const Face& v = proposed_.faces[f];
        return face_quality(at[v[0]], at[v[1]], at[v[2]]);
      };
      const double folded = 180 - dihedral_angle(at[a], at[b], opposite(x), opposite(y)) * 180 / M_PI;
      return PairMerit{int(folded / kSameFold), proposed_.votes[x] + proposed_.votes[y],
                       quality(x) + quality(y)};
    };
    for (const std::size_t f : faces) {
      // f stays if a pair with it is surely better than all pairs without it.
      bool in_best = false;
      for (const std::size_t g : faces) {
        bool best = g != f;
        for (std::size_t i = 0; best && i < faces.size(); ++i)
          for (std::size_t j = i + 1; best && j < faces.size(); ++j)
            if (faces[i] != f && faces[j] != f) best = surely_better(merit(f, g), merit(faces[i], faces[j]));
        in_best = in_best || best;
      }
      if (!in_best) wins[f] = 0;
    }
  }
  ASSERT_GT(crowded, 100u);
  Mesh mesh = mesh_of(at, kept.faces);
  EXPECT_EQ(test::edge_census(mesh).crowded, 0u);
  const std::vector<Face> stayed = all_unordered(kept.faces);
  std::size_t winners = 0;
  for (std::size_t f = 0; f < proposed_.faces.size(); ++f) {
    if (wins[f] == 0) continue;
    ++winners;
    EXPECT_TRUE(std::binary_search(stayed.begin(), stayed.end(), unordered(proposed_.faces[f])));
  }
  EXPECT_GT(winners, at.size()) << "most faces win";
  const std::vector<Face> all = all_unordered(proposed_.faces);
  EXPECT_TRUE(std::includes(all.begin(), all.end(), stayed.begin(), stayed.end()));
}

INSTANTIATE_TEST_SUITE_P(Shapes, FacesOfShape, testing::ValuesIn(test::clean_shapes()), test::NameOfShape());

TEST(FlattestPair, OfThreePagesTheTwoThatLieFlatStay) {
  // Two faces in the plane z = 0 and one upright on their common edge, with more votes than either.
  const Positions at = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0}, {0.5, 0, 1}};
  const ProposedFaces proposed{{{0, 1, 4}, {0, 1, 2}, {0, 3, 1}}, {3, 1, 1}};
  const FlattestPairs kept = keep_flattest_pairs(at, proposed, kSameFold, {});
  EXPECT_EQ(kept.faces, (std::vector<Face>{{0, 1, 2}, {0, 3, 1}}));
  EXPECT_EQ(kept.one_ring.degree(4), 0u);
}

TEST(FlattestPair, WithinTheSameFoldVotesChoose) {
  // Three faces whose folds differ by less than a step: the two with votes stay, though others are flatter.
  const Positions at = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0}, {0.5, -1, 0.1}};
  const ProposedFaces proposed{{{0, 1, 2}, {0, 3, 1}, {0, 4, 1}}, {3, 1, 3}};
  EXPECT_EQ(keep_flattest_pairs(at, proposed, kSameFold, {}).faces,
            (std::vector<Face>{{0, 1, 2}, {0, 4, 1}}));
  EXPECT_EQ(keep_flattest_pairs(at, proposed, 1, {}).faces, (std::vector<Face>{{0, 1, 2}, {0, 3, 1}}))
      << "5.7 degrees are more than a step";
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
