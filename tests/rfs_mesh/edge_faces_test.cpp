#include "rfs_mesh/edge_faces.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

TEST(Corners, OfAFaceInItsOrder) {
  const Face face = {7, 4, 9};
  for (Index k = 0; k < 3; ++k) {
    const Index v = face[k], next = face[(k + 1) % 3], last = face[(k + 2) % 3];
    EXPECT_EQ(corner_of(face, v), k);
    EXPECT_TRUE(has_corner(face, v));
    EXPECT_EQ(third_corner(face, next, last), v);
    EXPECT_EQ(other_corners(face, v).next, next);
    EXPECT_EQ(other_corners(face, v).last, last);
  }
  EXPECT_FALSE(has_corner(face, 5));
  EXPECT_EQ(edge_between(9, 4), (Edge{4, 9}));
  EXPECT_EQ(edge_between(4, 9), (Edge{4, 9}));
}

/// Pages of a book: faces at the edge 0-1, wound one way and the other, at angles that ascend in `order`.
Mesh book(const std::vector<std::size_t>& order, const Eigen::Affine3d& pose) {
  Mesh mesh;
  mesh.positions = {pose * Eigen::Vector3d(0, 0, 0), pose * Eigen::Vector3d(0, 0, 1)};
  mesh.faces.resize(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const double angle = -3 + 6 * double(k) / double(order.size());
    const auto tip = Index(mesh.positions.size());
    mesh.positions.push_back(pose * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.3));
    mesh.faces[order[k]] = k % 2 == 0 ? Face{0, 1, tip} : Face{tip, 1, 0};
  }
  return mesh;
}

TEST(EdgeFaces, ByAngleGoesRoundTheEdge) {
  const std::vector<std::size_t> order = {3, 0, 4, 2, 1};
  for (const double turn : {0.0, 0.8, 2.5}) {
    const Eigen::Affine3d pose(Eigen::AngleAxisd(turn, Eigen::Vector3d(1, 2, 3).normalized()));
    const Mesh mesh = book(order, pose);
    const std::vector<EdgeFace> all = edge_faces(mesh.faces);
    ASSERT_EQ(all.size(), 3 * order.size());
    std::size_t crowded = 0;
    for_each_edge(all, [&](const EdgeFace* first, const EdgeFace* last) {
      if (last - first < 3) return;
      ++crowded;
      const std::vector<EdgeFace> round = by_angle(mesh, first, last);
      ASSERT_EQ(round.size(), order.size());
      const auto start = std::size_t(
          std::find_if(round.begin(), round.end(), [&](const EdgeFace& e) { return e.face == order[0]; }) -
          round.begin());
      for (std::size_t k = 0; k < order.size(); ++k) {
        const EdgeFace& e = round[(start + k) % order.size()];
        EXPECT_EQ(e.face, order[k]) << turn;
        EXPECT_EQ(e.opposite(mesh.faces), Index(2 + k));
      }
    });
    EXPECT_EQ(crowded, 1u);
  }
}

}  // namespace
