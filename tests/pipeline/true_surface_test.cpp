#include "pipeline/true_surface.h"

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

using namespace rfsmooth;
using namespace rfsmooth::pipeline;
using Eigen::Vector3d;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  Vector3d in_cube(double half) { return {coordinate(half), coordinate(half), coordinate(half)}; }
  double coordinate(double half) { return std::uniform_real_distribution<double>(-half, half)(engine_); }

 private:
  std::mt19937_64 engine_;
};

/// The unit cube [0, 1]^3 with outward faces.
const Positions kCubeCorners = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
const std::vector<Face> kCubeFaces = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                      {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};

/// Signed distance to the unit cube, from its definition.
double cube_distance(const Vector3d& p) {
  const Vector3d d = (p - Vector3d::Constant(0.5)).cwiseAbs() - Vector3d::Constant(0.5);
  return d.cwiseMax(0.0).norm() + std::min(d.maxCoeff(), 0.0);
}

TEST(NearestOnTriangle, BeatsEveryPointOfAFineGrid) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    const std::array<Vector3d, 3> t = {random.in_cube(1), random.in_cube(1), random.in_cube(1)};
    const Vector3d q = random.in_cube(2);
    const TrianglePoint on = nearest_on_triangle(q, t);
    double best = kInfinity;
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j)
        best = std::min(best, (t[0] + (t[1] - t[0]) * i / kSteps + (t[2] - t[0]) * j / kSteps - q).norm());
    const double found = (on.point - q).norm();
    EXPECT_LE(found, best + 1e-12);
    EXPECT_GE(found, best - 0.1) << "no point of the triangle is that near";
    // The point lies in the triangle's plane.
    const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    EXPECT_NEAR(normal.dot(on.point - t[0]), 0, 1e-12);
  }
}

TEST(NearestOnTriangle, NamesTheFeature) {
  const std::array<Vector3d, 3> t = {Vector3d(0, 0, 0), Vector3d(4, 0, 0), Vector3d(0, 4, 0)};
  EXPECT_EQ(nearest_on_triangle({1, 1, 5}, t).feature, 0);
  EXPECT_EQ(nearest_on_triangle({3, 3, 1}, t).feature, 1);
  EXPECT_EQ(nearest_on_triangle({-1, 1, 1}, t).feature, 2);
  EXPECT_EQ(nearest_on_triangle({1, -1, 1}, t).feature, 3);
  EXPECT_EQ(nearest_on_triangle({-1, -1, 1}, t).feature, 4);
  EXPECT_EQ(nearest_on_triangle({9, -1, 1}, t).feature, 5);
  EXPECT_EQ(nearest_on_triangle({-1, 9, 1}, t).feature, 6);
}

TEST(NearestOnTriangle, DegenerateTrianglesAreSegmentsAndPoints) {
  const Vector3d a(0, 0, 0), b(2, 0, 0), c(1, 0, 0);
  EXPECT_EQ(nearest_on_triangle({1.5, 3, 0}, {a, b, c}).point, Vector3d(1.5, 0, 0));
  EXPECT_EQ(nearest_on_triangle({7, 3, 0}, {a, b, c}).point, b);
  EXPECT_EQ(nearest_on_triangle({7, 3, 0}, {c, c, c}).point, c);
}

TEST(PointTree, EqualsBruteForceAlsoInTies) {
  Random random(2);
  Positions points;
  for (int i = 0; i < 500; ++i) points.push_back(random.in_cube(1));
  for (int i = 0; i < 500; ++i)
    points.push_back((4 * random.in_cube(1)).array().round() / 4);  // a grid, repeated
  const PointTree tree(points);
  for (int round = 0; round < 500; ++round) {
    const Vector3d q = round % 2 ? random.in_cube(1.5) : points[std::size_t(round)];
    const Index skip = round % 2 ? kNone : Index(round);
    Index best = kNone;
    double squared = kInfinity;
    for (Index i = 0; i < points.size(); ++i) {
      const double d = (points[i] - q).squaredNorm();
      if (i != skip && d < squared) {
        squared = d;
        best = i;
      }
    }
    const PointTree::Hit hit = tree.nearest(q, skip);
    EXPECT_EQ(hit.point, best);
    EXPECT_EQ(hit.squared, squared);
  }
}

TEST(PointTree, DistanceFromTriangleEqualsBruteForce) {
  Random random(3);
  Positions points;
  for (int i = 0; i < 300; ++i) points.push_back(random.in_cube(1));
  const PointTree tree(points);
  for (int round = 0; round < 100; ++round) {
    const std::array<Vector3d, 3> t = {random.in_cube(2), random.in_cube(2), random.in_cube(2)};
    double best = kInfinity;
    for (const Vector3d& p : points)
      best = std::min(best, (nearest_on_triangle(p, t).point - p).squaredNorm());
    EXPECT_EQ(tree.squared_distance_from(t), best);
  }
}

TEST(PointTree, EmptyAndSinglePoint) {
  EXPECT_EQ(PointTree({}).nearest({0, 0, 0}).point, kNone);
  const PointTree one({Vector3d(1, 2, 3)});
  EXPECT_EQ(one.nearest({1, 2, 3}).squared, 0);
  EXPECT_EQ(one.nearest({1, 2, 3}, 0).point, kNone);
}

TEST(TrueSurface, NearestEqualsBruteForceOnASoup) {
  Random random(4);
  Positions vertices;
  std::vector<Face> faces;
  for (Index f = 0; f < 200; ++f) {
    const Vector3d centre = random.in_cube(1);
    for (int k = 0; k < 3; ++k) vertices.push_back(centre + random.in_cube(0.2));
    faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  const TrueSurface surface(vertices, faces);
  EXPECT_FALSE(surface.closed());
  for (int round = 0; round < 300; ++round) {
    const Vector3d q = random.in_cube(1.5);
    double best = kInfinity;
    for (std::size_t f = 0; f < faces.size(); ++f)
      best = std::min(best, (nearest_on_triangle(q, surface.corners(f)).point - q).squaredNorm());
    EXPECT_EQ(surface.nearest(q).squared, best);
  }
}

TEST(TrueSurface, SignedDistanceToACubeIsItsDefinition) {
  Random random(5);
  std::vector<Face> inward = kCubeFaces;
  for (auto& face : inward) std::swap(face[0], face[1]);
  Positions soup;  // every face with its own corners, as from an STL file
  std::vector<Face> soup_faces;
  for (const auto& face : kCubeFaces) {
    const Index first = Index(soup.size());
    for (const Index v : face) soup.push_back(kCubeCorners[v]);
    soup_faces.push_back({first, first + 1, first + 2});
  }
  for (const TrueSurface& surface : {TrueSurface(kCubeCorners, kCubeFaces), TrueSurface(kCubeCorners, inward),
                                     TrueSurface(soup, soup_faces)}) {
    EXPECT_TRUE(surface.closed());
    EXPECT_DOUBLE_EQ(surface.area(), 6);
    EXPECT_DOUBLE_EQ(surface.volume(), 1);
    for (int round = 0; round < 1000; ++round) {
      const Vector3d q = Vector3d::Constant(0.5) + random.in_cube(1.2);
      EXPECT_NEAR(surface.signed_distance(q), cube_distance(q), 1e-12) << q.transpose();
    }
  }
}

TEST(TrueSurface, AMissingFaceMeansOpen) {
  std::vector<Face> open = kCubeFaces;
  open.pop_back();
  EXPECT_FALSE(TrueSurface(kCubeCorners, open).closed());
  std::vector<Face> turned = kCubeFaces;
  std::swap(turned[3][0], turned[3][1]);
  EXPECT_FALSE(TrueSurface(kCubeCorners, turned).closed());
}

TEST(TrueSurface, BrokenIndicesThrow) {
  EXPECT_THROW(TrueSurface(kCubeCorners, {{0, 1, 8}}), std::invalid_argument);
  EXPECT_THROW(TrueSurface(kCubeCorners, {}), std::invalid_argument);
}

}  // namespace
