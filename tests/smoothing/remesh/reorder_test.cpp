#include "smoothing/remesh/reorder.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using rfsmooth::Mesh;

namespace {

Mesh shuffled(const Mesh& mesh, std::vector<Index>& place) {
  place.resize(mesh.positions.size());
  std::iota(place.begin(), place.end(), Index(0));
  std::shuffle(place.begin(), place.end(), std::mt19937_64(1));
  Mesh out;
  out.positions.resize(place.size());
  for (std::size_t i = 0; i < place.size(); ++i) out.positions[place[i]] = mesh.positions[i];
  for (const auto& f : mesh.faces) out.faces.push_back({place[f[0]], place[f[1]], place[f[2]]});
  for (const auto& e : mesh.loose_edges)
    out.loose_edges.push_back({std::min(place[e[0]], place[e[1]]), std::max(place[e[0]], place[e[1]])});
  std::sort(out.loose_edges.begin(), out.loose_edges.end());
  rebuild_adjacency(out, {});
  return out;
}

TEST(Reorder, KeepsTheMeshAndItsInvariants) {
  for (const Mesh& mesh : support::all_small()) {
    const Reordered near = reorder(mesh, {});
    EXPECT_TRUE(check(near.mesh).empty());
    ASSERT_EQ(near.place.size(), mesh.positions.size());
    for (std::size_t i = 0; i < near.place.size(); ++i)
      EXPECT_EQ(near.mesh.positions[near.place[i]], mesh.positions[i]);
    ASSERT_EQ(near.mesh.faces.size(), mesh.faces.size());
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
      for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(near.mesh.faces[f][c], near.place[mesh.faces[f][c]]);
  }
}

TEST(Reorder, ALargeShuffledMeshIsSmoothedLikeAnOrderedOneAndComesBackInItsOwnOrder) {
  Mesh ordered = support::torus(400, 260, 0.4);
  support::add_noise(ordered, 0.2 * support::mean_edge(ordered), 1);
  ordered = reorder(ordered, {}).mesh;
  std::vector<Index> place;
  Mesh mixed = shuffled(ordered, place);
  EXPECT_FALSE(is_scattered(ordered, {}));
  ASSERT_TRUE(is_scattered(mixed, {}));
  const Constraints fixed{{{7, HardConstraint::Kind::fixed, Eigen::Vector3d::Zero()}},
                          std::vector<double>(place.size(), 0.5)};
  Constraints fixed_mixed = reorder(fixed, place);
  HcOptions o;
  o.iterations = 2;
  const Eigen::Vector3d still = ordered.positions[7];
  ASSERT_TRUE(smooth(ordered, {o}, {}, fixed).ok());
  ASSERT_TRUE(smooth(mixed, {o}, {}, fixed_mixed).ok());
  EXPECT_EQ(mixed.positions[place[7]], still);
  Positions back(place.size());
  for (std::size_t i = 0; i < place.size(); ++i) back[i] = mixed.positions[place[i]];
  EXPECT_LT(support::rms_distance(back, ordered.positions), 1e-14);
}

}  // namespace
