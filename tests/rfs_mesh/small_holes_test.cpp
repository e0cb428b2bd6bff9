#include "rfs_mesh/small_holes.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include <rfsmooth/connect.h>

#include "rfs_mesh/measure.h"
#include "tests/support/edge_census.h"
#include "tests/support/shapes.h"

namespace rfsmooth::rfs_mesh {
namespace {

constexpr double kQuality = 0.35;  // the default

const Positions kOctahedron = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
const std::vector<Face> kSides = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                  {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

TEST(SmallHoles, EveryMissingSideOfAnOctahedronComesBackWoundAsItWas) {
  for (std::size_t missing = 0; missing < kSides.size(); ++missing) {
    std::vector<Face> faces = kSides;
    faces.erase(faces.begin() + std::ptrdiff_t(missing));
    fill_small_holes(kOctahedron, kQuality, faces, {});
    ASSERT_EQ(faces.size(), kSides.size());
    Face back = faces.back();
    std::rotate(back.begin(), std::find(back.begin(), back.end(), kSides[missing][0]), back.end());
    EXPECT_EQ(back, kSides[missing]);
  }
}

TEST(SmallHoles, OfTwoNeighboursThatAreMissingNeitherIsAHoleOfThree) {
  std::vector<Face> faces(kSides.begin() + 2, kSides.end());
  fill_small_holes(kOctahedron, kQuality, faces, {});
  EXPECT_EQ(faces.size(), kSides.size() - 2);
}

TEST(SmallHoles, AFaceAloneIsNoHoleAndSliversAndFoldsAreNotFilled) {
  std::vector<Face> faces = {{0, 2, 4}};
  fill_small_holes(kOctahedron, kQuality, faces, {});
  EXPECT_EQ(faces.size(), 1u);
  // Three faces of a tetrahedron: the fourth has dihedral angles of 70.5 degrees, folded.
  const Positions tetrahedron = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
  fill_small_holes(tetrahedron, kQuality, faces, {});
  EXPECT_EQ(faces.size(), 3u);
  // Flattened to a needle in a plane the fourth is no face either.
  const Positions needle = {{0, 0, 0},   {1, 0, 0},  {2, 0.1, 0}, {3, 0, 0},
                            {1.5, 5, 0}, {1, -5, 0}, {2, -5, 0}};
  faces = {{1, 3, 4}, {1, 2, 5}, {2, 3, 6}};
  fill_small_holes(needle, kQuality, faces, {});
  EXPECT_EQ(faces.size(), 3u);
}

/// Of a rough mesh: no hole of three edges is left that could be filled, no edge is new, none has three
/// faces.
TEST(SmallHoles, TheRoughMeshHasNone) {
  const test::Shape torus = test::torus();
  std::mt19937_64 engine(3);
  Positions points(4000);
  for (Eigen::Vector3d& p : points) p = torus.sample(engine);
  const auto connection = rfsmooth::connect(points, {}, {});
  ASSERT_TRUE(connection.ok());
  const Mesh& mesh = connection.value().mesh;
  EXPECT_TRUE(check(mesh).empty());
  std::vector<Face> faces = mesh.faces;
  fill_small_holes(points, kQuality, faces, {});
  EXPECT_EQ(faces.size(), mesh.faces.size());
  EXPECT_EQ(test::edge_census(mesh).crowded, 0u);
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
