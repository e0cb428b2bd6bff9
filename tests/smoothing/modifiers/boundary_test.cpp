// The boundary rules as part of a flow: Desbrun 5.3.
#include "smoothing/modifiers/boundary.h"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "smoothing/operators/operator.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

constexpr int kAround = 20;

/// A tube whose lower rim is the vertices 0 .. kAround - 1, in order.
Mesh rough_tube() {
  Mesh mesh = support::cylinder(kAround, 7, 0.3);
  support::add_noise(mesh, 0.03, 5);
  return mesh;
}

/// The 1-D scale-dependent operator on the lower rim, times the square of the rims' mean edge: h^2 L.
Eigen::MatrixXd rim_operator(const Mesh& mesh) {
  const auto length = [&](Index a, Index b) { return (mesh.positions[a] - mesh.positions[b]).norm(); };
  double h = 0;  // both rims are the boundary
  const auto upper = Index(mesh.positions.size() - kAround);
  for (Index i = 0; i < kAround; ++i)
    h += (length(i, (i + 1) % kAround) + length(upper + i, upper + (i + 1) % kAround)) / (2 * kAround);
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(kAround, kAround);
  for (Index i = 0; i < kAround; ++i) {
    const Index on = (i + 1) % kAround, back = (i + kAround - 1) % kAround;
    const double D = length(i, on), d = length(i, back);
    L(i, on) -= 2 / (d + D) / D;
    L(i, back) -= 2 / (d + D) / d;
    L(i, i) += 2 / (d + D) * (1 / d + 1 / D);
  }
  return h * h * L;
}

Eigen::MatrixXd rim_of(const Mesh& mesh) {
  Eigen::MatrixXd x(kAround, 3);
  for (Index i = 0; i < kAround; ++i) x.row(i) = mesh.positions[i].transpose();
  return x;
}

Mesh after_one_step(Mesh mesh, const AnyFlow& flow, Boundary rule) {
  FlowOptions o{flow};
  o.modifiers.boundary = rule;
  iterations(o.flow) = 1;
  const auto run = smooth(mesh, o, {});
  EXPECT_TRUE(run.ok()) << (run.ok() ? "" : run.error().message);
  return mesh;
}

TEST(BoundaryCurve, SolvesAlongTheRimWithTheTimeStepAndOrderOfTheFlow) {
  const Mesh start = rough_tube();
  const Eigen::MatrixXd L = rim_operator(start), I = Eigen::MatrixXd::Identity(kAround, kAround);
  for (const OperatorKind op : {OperatorKind::umbrella, OperatorKind::curvature})
    for (const int order : {1, 2})
      for (const double dt : {0.5, 20.0}) {
        ImplicitOptions o;
        o.op = op;
        o.order = order;
        o.dt = dt;
        o.tolerance = 1e-13;
        const Eigen::MatrixXd expected =
            (I + dt * (order == 1 ? L : Eigen::MatrixXd(L * L))).partialPivLu().solve(rim_of(start));
        EXPECT_LT((rim_of(after_one_step(start, o, Boundary::curve)) - expected).norm(), 1e-8)
            << int(op) << order << dt;
      }
}

TEST(BoundaryCurve, StepsAlongTheRimWithTheStepOfTheFlow) {
  const Mesh start = rough_tube();
  const Eigen::MatrixXd L = rim_operator(start);
  for (const double lambda : {0.01, 0.1}) {
    CurvatureOptions curvature;
    MedianDirectionOptions median;
    curvature.lambda = median.lambda = lambda;
    const Eigen::MatrixXd expected = rim_of(start) - lambda * L * rim_of(start);
    for (const AnyFlow& flow : {AnyFlow(curvature), AnyFlow(median)})
      EXPECT_LT((rim_of(after_one_step(start, flow, Boundary::curve)) - expected).norm(), 1e-12)
          << name_of(flow) << lambda;
  }
}

TEST(BoundaryCurve, UmbrellaFlowsTakeTheTwoNeighboursAlongTheRim) {
  const Mesh start = rough_tube();
  LaplacianOptions o;
  o.lambda = 0.7;
  const Mesh after = after_one_step(start, o, Boundary::curve);
  for (Index i = 0; i < kAround; ++i) {
    const Vector3d mean =
        0.5 * (start.positions[(i + 1) % kAround] + start.positions[(i + kAround - 1) % kAround]);
    EXPECT_LT((after.positions[i] - (0.3 * start.positions[i] + 0.7 * mean)).norm(), 1e-14);
  }
}

TEST(BoundaryCurve, TheInvariantIsRestoredAfterTheRimHasMoved) {
  Mesh mesh = rough_tube();
  const double area = support::area(mesh);
  FlowOptions o{ImplicitOptions()};
  o.modifiers.boundary = Boundary::curve;
  o.modifiers.preserve = Preserve::area;
  ASSERT_TRUE(smooth(mesh, o, {}).ok());
  EXPECT_NEAR(support::area(mesh) / area, 1, 1e-9);
}

/// The same mesh with the fans over its two rims spelled out as faces.
Mesh closed_by_hand(const Mesh& tube) {
  Mesh mesh = tube;
  const auto n = Index(tube.positions.size());
  Vector3d lower = Vector3d::Zero(), upper = Vector3d::Zero();
  for (Index i = 0; i < kAround; ++i) {
    lower += tube.positions[i] / kAround;
    upper += tube.positions[n - kAround + i] / kAround;
    mesh.faces.push_back({(i + 1) % kAround, i, n});
    mesh.faces.push_back({n - kAround + i, n - kAround + (i + 1) % kAround, Index(n + 1)});
  }
  mesh.positions.push_back(lower);
  mesh.positions.push_back(upper);
  rebuild_adjacency(mesh, {});
  return mesh;
}

TEST(VirtualVertex, MovesWithTheFlowFromTheBarycentreOn) {
  Mesh mesh = rough_tube(), closed = closed_by_hand(mesh);
  LaplacianOptions laplacian;
  laplacian.lambda = 0.3;
  laplacian.iterations = 6;
  FlowOptions o{laplacian};
  ASSERT_TRUE(smooth(closed, o, {}).ok());
  o.modifiers.boundary = Boundary::virtual_vertices;
  ASSERT_TRUE(smooth(mesh, o, {}).ok());
  closed.positions.resize(mesh.positions.size());
  EXPECT_LT(support::rms_distance(mesh.positions, closed.positions), 1e-13);
}

TEST(VirtualVertex, DoesNotLengthenTheMeanEdgeInWhichStepsAreMeasured) {
  const Mesh start = support::bowl(6);
  for (const AnyFlow& flow : {AnyFlow(CurvatureOptions()), AnyFlow(ModifiedCurvatureOptions()),
                              AnyFlow(MedianDirectionOptions())}) {
    const Mesh free = after_one_step(start, flow, Boundary::free),
               closed = after_one_step(start, flow, Boundary::virtual_vertices);
    int inner = 0;
    for (Index i = 0; i < start.positions.size(); ++i) {
      const Vector3d& p = start.positions[i];
      if (std::max(std::abs(p.x()), std::abs(p.y())) > 4.5) continue;  // no virtual vertex within two rings
      EXPECT_LT((free.positions[i] - closed.positions[i]).norm(), 1e-14) << name_of(flow);
      ++inner;
    }
    EXPECT_GT(inner, 50);
  }
}

}  // namespace
