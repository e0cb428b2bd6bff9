#include "clouds/shapes/shapes.h"

#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "pipeline/true_surface.h"

using namespace rfsmooth;
using namespace rfsmooth::clouds;
using Eigen::Vector3d;

namespace {

class EveryShape : public testing::TestWithParam<std::string_view> {
 protected:
  std::unique_ptr<Shape> shape_ = make_shape(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape, testing::ValuesIn(shape_names()),
                         [](const auto& test) { return std::string(test.param); });

constexpr double kEdge =
    0.03;  // of the meshes: they differ from curved shapes by about edge^2 / 8 radius = 3e-4
constexpr double kMeshError = 5e-4;

TEST_P(EveryShape, MeshLiesOnTheSurfaceAndIsSound) {
  const Mesh mesh = shape_->mesh(kEdge);
  EXPECT_TRUE(rfsmooth::check(mesh).empty());
  ASSERT_FALSE(mesh.positions.empty());
  for (const Vector3d& v : mesh.positions) EXPECT_NEAR(shape_->signed_distance(v), 0, 1e-9);
  const pipeline::TrueSurface surface(mesh.positions, mesh.faces);
  EXPECT_EQ(surface.closed(), shape_->volume().has_value());
  EXPECT_NEAR(surface.area() / shape_->area(), 1, 1e-3);
  if (shape_->volume()) {
    EXPECT_NEAR(surface.volume() / *shape_->volume(), 1, 2e-3);
  }
}

TEST_P(EveryShape, DistanceAndNormalAgreeWithTheMesh) {
  const Mesh mesh = shape_->mesh(kEdge);
  const pipeline::TrueSurface surface(mesh.positions, mesh.faces);
  Random random(1);
  const double reach = 1.3 * shape_->radius();
  for (int i = 0; i < 1000; ++i) {
    const Vector3d p = random.in_box(Vector3d::Constant(-reach), Vector3d::Constant(reach));
    const double d = shape_->signed_distance(p);
    EXPECT_NEAR(std::abs(d), std::sqrt(surface.nearest(p).squared), kMeshError) << p.transpose();
    if (surface.closed() && std::abs(d) > kMeshError) {
      EXPECT_NEAR(d, surface.signed_distance(p), kMeshError);
    }
    EXPECT_NEAR(shape_->normal(p).norm(), 1, 1e-12);
    EXPECT_LE(shape_->clearance(p), std::abs(d) + 1e-12);
  }
}

TEST_P(EveryShape, SurfacePointsLieOnTheSurfaceWithItsNormal) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d p = shape_->surface_point(random);
    EXPECT_NEAR(shape_->signed_distance(p), 0, 1e-12);
    EXPECT_LE(p.norm(), shape_->radius() + 1e-12);
    if (shape_->edge_distance(p) < 1e-3) continue;
    const Vector3d n = shape_->normal(p);
    EXPECT_NEAR(shape_->signed_distance(p + 1e-4 * n), 1e-4, 1e-7);
    EXPECT_NEAR(shape_->signed_distance(p - 1e-4 * n), -1e-4, 1e-7);
  }
}

TEST_P(EveryShape, SurfacePointsAreAsDenseAsTheySay) {
  // Mean position of the points, weighted by 1 / density, is the surface's centroid; compare with the mesh's.
  const Mesh mesh = shape_->mesh(kEdge);
  Vector3d centroid = Vector3d::Zero();
  double area = 0;
  for (const Face& face : mesh.faces) {
    const Vector3d &a = mesh.positions[face[0]], &b = mesh.positions[face[1]], &c = mesh.positions[face[2]];
    const double face_area = 0.5 * (b - a).cross(c - a).norm();
    centroid += face_area * (a + b + c) / 3;
    area += face_area;
  }
  centroid /= area;
  Random random(3);
  Vector3d mean = Vector3d::Zero();
  double weights = 0;
  constexpr int kCount = 200000;
  for (int i = 0; i < kCount; ++i) {
    const Vector3d p = shape_->surface_point(random);
    mean += p / shape_->density(p);
    weights += 1 / shape_->density(p);
  }
  EXPECT_LT((mean / weights - centroid).norm(), 0.015);
}

TEST(Shapes, EdgesOfTheCube) {
  const auto cube = make_cube();
  EXPECT_DOUBLE_EQ(cube->edge_distance({1, 1, 0}), 0);
  EXPECT_DOUBLE_EQ(cube->edge_distance({1, 0, 0}), 1);
  EXPECT_DOUBLE_EQ(cube->edge_distance({0, 0, 0}), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(*cube->volume(), 8);
  EXPECT_DOUBLE_EQ(cube->area(), 24);
}

TEST(Shapes, TheLPartHasAnInnerEdgeAndNoEdgeWhereCellsMeet) {
  const auto part = make_l_part();
  EXPECT_NEAR(part->edge_distance({-0.2, 0.2, 0}), 0, 1e-12) << "the inner corner";
  EXPECT_NEAR(part->edge_distance({-1, 0.2, 0}), 0.5, 1e-12) << "a cell border on a flat wall";
  EXPECT_GT(part->signed_distance({0.5, -0.5, 0}), 0.4) << "the notch is outside";
  EXPECT_NEAR(*part->volume(), (4 - 1.44) * 1, 1e-12);
  EXPECT_NEAR(part->area(), 2 * (4 - 1.44) + 8 * 1, 1e-12);
}

TEST(Shapes, UnknownNameIsNull) {
  EXPECT_EQ(make_shape("teapot"), nullptr);
}

}  // namespace
