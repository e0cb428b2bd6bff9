#include "smoothing/integrators/umbrella_speed.h"

#include <gtest/gtest.h>

#include "smoothing/operators/operator.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

constexpr Index kPair = 30;  // lies where a neighbour does
constexpr Index kLump = 82;  // lies where all of its neighbours do

Mesh with_coincident_vertices() {
  Mesh mesh = support::bowl(5);
  support::add_noise(mesh, 0.1, 1);
  mesh.positions[kPair] = mesh.positions[mesh.one_ring[kPair][0]];
  for (const Index j : mesh.one_ring[kLump]) mesh.positions[j] = mesh.positions[kLump];
  return mesh;
}

class UmbrellaSpeeds : public testing::TestWithParam<UmbrellaWeights> {
 protected:
  Positions speed(const Mesh& mesh) const {
    Positions speed;
    make_umbrella_speed(GetParam())->evaluate(mesh, speed, {});
    return speed;
  }
};

INSTANTIATE_TEST_SUITE_P(EveryWeight, UmbrellaSpeeds,
                         testing::Values(UmbrellaWeights::equal, UmbrellaWeights::inverse_distance));

TEST_P(UmbrellaSpeeds, AreTheOperatorsWithTheOtherSignAlsoWhereVerticesCoincide) {
  const Mesh mesh = with_coincident_vertices();
  const Operator op =
      GetParam() == UmbrellaWeights::equal ? umbrella(mesh.one_ring, {}) : inverse_distance(mesh, {});
  Positions outward;
  apply(mesh.one_ring, op, mesh.positions, outward, {});
  const Positions found = speed(mesh);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_LT((found[i] + outward[i]).norm(), 1e-12) << i;
  EXPECT_LT(found[kLump].norm(), 1e-12);
}

TEST_P(UmbrellaSpeeds, AreZeroWithoutNeighbours) {
  Mesh mesh;
  mesh.positions = {{1, 2, 3}, {4, 5, 6}};
  mesh.one_ring = make_adjacency(2, {}, {});
  for (const Eigen::Vector3d& v : speed(mesh)) EXPECT_EQ(v, Eigen::Vector3d(0, 0, 0));
}

TEST(UmbrellaSpeed, OfInverseDistanceLeavesOutWhoIsAtTheSamePlace) {
  Mesh mesh = with_coincident_vertices();
  const auto speed = make_umbrella_speed(UmbrellaWeights::inverse_distance);
  const Eigen::Vector3d found = speed->at(mesh, kPair);
  std::vector<Edge> others;
  for (std::size_t k = 1; k < mesh.one_ring.degree(kPair); ++k)
    others.push_back({kPair, mesh.one_ring[kPair][k]});
  mesh.one_ring = make_adjacency(mesh.positions.size(), others, {});
  EXPECT_GT(found.norm(), 0.01);
  EXPECT_LT((found - speed->at(mesh, kPair)).norm(), 1e-12);
}

}  // namespace
