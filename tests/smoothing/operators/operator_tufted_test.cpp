#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "smoothing/operators/operator.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

/// Pages of needles on one spine: non-manifold, with strongly negative cotangents.
Mesh needle_book() {
  Mesh mesh = support::non_manifold_fan();
  for (Vector3d& p : mesh.positions) p.x() *= 7;
  support::add_noise(mesh, 0.1, 3);
  return mesh;
}

double least_weight(const Mesh& mesh, OperatorKind kind) {
  OperatorSource source(kind, false);
  const auto& weight = source.on(mesh, {}).weight;
  return *std::min_element(weight.begin(), weight.end());
}

TEST(Tufted, HasNoNegativeWeightWhereTheCurvatureOperatorDoes) {
  for (Mesh& mesh : support::all_small()) {
    support::add_noise(mesh, 0.1 * support::mean_edge(mesh), 1);
    EXPECT_GE(least_weight(mesh, OperatorKind::tufted), 0);
  }
  EXPECT_LT(least_weight(needle_book(), OperatorKind::curvature), -0.1);
  EXPECT_GE(least_weight(needle_book(), OperatorKind::tufted), 0);
}

TEST(Tufted, IsTheCurvatureOperatorOnAClosedDelaunayMesh) {
  const Mesh mesh = support::icosphere(3);
  ASSERT_GT(least_weight(mesh, OperatorKind::curvature), 0) << "else it is not Delaunay";
  OperatorSource curvature(OperatorKind::curvature, false), tufted(OperatorKind::tufted, false);
  Positions expected, y;
  const Operator& c = curvature.on(mesh, {});
  const Operator& t = tufted.on(mesh, {});
  apply(c.rows(mesh), c, mesh.positions, expected, {});
  apply(t.rows(mesh), t, mesh.positions, y, {});
  for (std::size_t i = 0; i < y.size(); ++i)
    EXPECT_LT((y[i] - expected[i]).norm(), 1e-9 * expected[i].norm());
}

TEST(Tufted, OfASphereOfBadTrianglesIsOneOverItsRadius) {
  Mesh mesh = support::icosphere(4);
  support::add_noise(mesh, 0.25 * support::mean_edge(mesh), 5);
  for (Vector3d& p : mesh.positions) p.normalize();
  OperatorSource source(OperatorKind::tufted, false);
  const Operator& op = source.on(mesh, {});
  Positions y;
  apply(op.rows(mesh), op, mesh.positions, y, {});
  double mean = 0;
  for (std::size_t i = 0; i < y.size(); ++i) mean += y[i].dot(mesh.positions[i]) / double(y.size());
  EXPECT_NEAR(mean, 1, 0.03);
}

/// A sheared grid of obtuse triangles with one vertex raised and a fin on one of its edges.
Mesh spiked_grid() {
  Mesh mesh = support::grid(9, 9);
  for (Vector3d& p : mesh.positions) p.x() = 4 * p.x() + 4 * p.y();
  mesh.positions[40].z() = 1;
  mesh.positions.emplace_back(mesh.positions[41] + Vector3d(0, 0, 1));
  mesh.faces.push_back({40, 41, Index(mesh.positions.size() - 1)});
  rebuild_adjacency(mesh, {});
  return mesh;
}

/// The largest way out of the first mesh's bounding box.
double excursion(const Positions& before, const Positions& after) {
  Eigen::AlignedBox<double, 3> box;
  for (const Vector3d& p : before) box.extend(p);
  double out = 0;
  for (const Vector3d& p : after) out = std::max(out, box.exteriorDistance(p));
  return out;
}

TEST(Tufted, AnImplicitStepStaysInTheBoundingBoxOfANonManifoldMeshTheCurvatureOperatorDoesNot) {
  const auto out = [](OperatorKind op) {
    Mesh mesh = spiked_grid();
    ImplicitOptions o;
    o.op = op;
    o.order = 1;
    o.dt = 3;
    o.tolerance = 1e-12;
    const Positions before = mesh.positions;
    EXPECT_TRUE(smooth(mesh, {o}, {}).ok());
    return excursion(before, mesh.positions);
  };
  EXPECT_LT(out(OperatorKind::tufted), 1e-9);
  EXPECT_GT(out(OperatorKind::curvature), 1e-3);
}

// Signed weights keep the energy of the operator positive, and every vertex is limited to its own stable
// step: what explicit curvature flow rests on where meshes are not manifold.
TEST(SignedCotangents, CurvatureFlowLowersTheAreaOfANonManifoldMesh) {
  Mesh mesh = needle_book();
  CurvatureOptions o;
  o.iterations = 1;
  double before = support::area(mesh);
  for (int step = 0; step < 20; ++step) {
    ASSERT_TRUE(smooth(mesh, {o}, {}).ok());
    EXPECT_LT(support::area(mesh), before);
    before = support::area(mesh);
  }
}

}  // namespace
