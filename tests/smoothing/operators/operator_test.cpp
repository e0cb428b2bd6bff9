#include "smoothing/operators/operator.h"

#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

Positions applied(const Mesh& mesh, OperatorKind kind) {
  OperatorSource source(kind, false);
  const Operator& op = source.on(mesh, {});
  Positions y;
  apply(op.rows(mesh), op, mesh.positions, y, {});
  return y;
}

Positions random_field(std::size_t n, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  Positions x(n);
  for (Vector3d& p : x) p = Vector3d(coordinate(engine), coordinate(engine), coordinate(engine));
  return x;
}

double inner(const Operator& op, const Positions& x, const Positions& y) {
  double total = 0;
  for (std::size_t i = 0; i < x.size(); ++i) total += op.mass[i] * x[i].dot(y[i]);
  return total;
}

class EveryOperator : public testing::TestWithParam<OperatorKind> {};
INSTANTIATE_TEST_SUITE_P(Operators, EveryOperator,
                         testing::Values(OperatorKind::umbrella, OperatorKind::inverse_distance,
                                         OperatorKind::scale_dependent, OperatorKind::curvature,
                                         OperatorKind::curvature_normalised));

TEST_P(EveryOperator, ConstantsAreInTheNullSpace) {
  for (Mesh& mesh : support::all_small()) {
    OperatorSource source(GetParam(), false);
    const Operator& op = source.on(mesh, {});
    Positions y;
    apply(op.rows(mesh), op, Positions(mesh.positions.size(), Vector3d(1, -2, 3)), y, {});
    EXPECT_EQ(y, Positions(mesh.positions.size(), Vector3d::Zero()));
  }
}

TEST_P(EveryOperator, SelfAdjointAndPositiveSemiDefiniteInItsInnerProduct) {
  for (Mesh& mesh : support::all_small()) {
    support::add_noise(mesh, 0.02, 1);
    OperatorSource source(GetParam(), false);
    const Operator& op = source.on(mesh, {});
    const std::size_t n = mesh.positions.size();
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const Positions x = random_field(n, seed), y = random_field(n, seed + 100);
      Positions lx, ly;
      apply(op.rows(mesh), op, x, lx, {});
      apply(op.rows(mesh), op, y, ly, {});
      const double size = std::abs(inner(op, lx, x)) + std::abs(inner(op, ly, y));
      EXPECT_NEAR(inner(op, lx, y), inner(op, x, ly), 1e-12 * size);
      EXPECT_GE(inner(op, lx, x), -1e-12 * size);
    }
  }
}

TEST_P(EveryOperator, TheWholeSpectrumIsNonNegative) {
  Mesh mesh = support::non_manifold_fan();
  OperatorSource source(GetParam(), false);
  const Operator& op = source.on(mesh, {});
  const auto n = Eigen::Index(mesh.positions.size());
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index k = op.rows(mesh).start[i]; k < op.rows(mesh).start[i + 1]; ++k) {
      const double w = op.weight.empty() ? 1 : op.weight[k];
      S(i, i) += w;
      S(i, op.rows(mesh).items[k]) -= w;
    }
  EXPECT_EQ(S, S.transpose());
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(S).eigenvalues();
  EXPECT_GE(values.minCoeff(), -1e-12 * values.maxCoeff());
}

TEST_P(EveryOperator, VanishesInsideARegularPlane) {
  for (const bool equilateral : {false, true}) {
    const Mesh mesh = support::grid(9, 8, equilateral);
    const Positions y = applied(mesh, GetParam());
    for (int r = 1; r < 7; ++r)
      for (int c = 1; c < 8; ++c) EXPECT_LT(y[std::size_t(r) * 9 + c].norm(), 1e-13);
  }
}

TEST_P(EveryOperator, KeptWeightsAreThoseOfTheFirstMesh) {
  Mesh mesh = support::icosphere(2);
  support::add_noise(mesh, 0.03, 1);
  OperatorSource kept(GetParam(), true), fresh(GetParam(), false);
  const std::vector<double> first = kept.on(mesh, {}).weight;
  EXPECT_EQ(fresh.on(mesh, {}).weight, first);
  support::add_noise(mesh, 0.03, 2);
  EXPECT_EQ(kept.on(mesh, {}).weight, first);
}

TEST(Curvature, VanishesInsideAnyPlanarMesh) {
  Mesh mesh = support::grid(9, 8);
  support::add_noise(mesh, 0.2, 1);
  for (Vector3d& p : mesh.positions) p.z() = 0;
  for (const OperatorKind kind :
       {OperatorKind::curvature, OperatorKind::curvature_normalised, OperatorKind::tufted}) {
    const Positions y = applied(mesh, kind);
    for (int r = 1; r < 7; ++r)
      for (int c = 1; c < 8; ++c) EXPECT_LT(y[std::size_t(r) * 9 + c].norm(), 1e-12);
  }
}

TEST(Curvature, OfASphereIsOneOverItsRadiusOutward) {
  for (const double radius : {0.5, 1.0, 4.0}) {
    Mesh mesh = support::icosphere(4);
    for (Vector3d& p : mesh.positions) p *= radius;
    const Positions y = applied(mesh, OperatorKind::curvature);
    ASSERT_EQ(y.size(), mesh.positions.size());
    for (std::size_t i = 0; i < y.size(); ++i)
      EXPECT_LT((y[i] - mesh.positions[i] / (radius * radius)).norm(), 0.02 / radius);
  }
}

TEST(Curvature, OfACylinderIsHalfOfOneOverItsRadius) {
  const int around = 96, rings = 12;
  const Mesh mesh = support::cylinder(around, rings, 0.05);
  const Positions y = applied(mesh, OperatorKind::curvature);
  for (int i = around; i < around * (rings - 1); ++i) {
    const Vector3d& p = mesh.positions[std::size_t(i)];
    EXPECT_LT((y[std::size_t(i)] - 0.5 * Vector3d(p.x(), p.y(), 0)).norm(), 0.02 * 0.5);
  }
}

TEST(Curvature, TheWholeOneRingInsteadOfTheMixedAreaWouldGiveAThird) {
  // Why the operator differs from Desbrun (14): with A = the area of the whole one-ring, H comes out as H
  // / 3.
  const Mesh mesh = support::icosphere(4);
  OperatorSource source(OperatorKind::curvature, false);
  const Operator& op = source.on(mesh, {});
  const Positions y = applied(mesh, OperatorKind::curvature);
  std::vector<double> ring(mesh.positions.size(), 0);
  for (const Face& f : mesh.faces) {
    const double area = 0.5 * (mesh.positions[f[1]] - mesh.positions[f[0]])
                                  .cross(mesh.positions[f[2]] - mesh.positions[f[0]])
                                  .norm();
    for (const Index v : f) ring[v] += area;
  }
  double paper = 0, ours = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    paper += y[i].norm() * op.mass[i] / (2 * ring[i]) / double(y.size());
    ours += y[i].norm() / double(y.size());
  }
  EXPECT_NEAR(paper, 1.0 / 3, 0.005);
  EXPECT_NEAR(ours, 1, 0.005);
}

TEST(Operators, OnARegularMeshUnitTimesOperatorIsTwiceTheUmbrella) {
  Mesh mesh = support::grid(13, 13, true);
  for (Vector3d& p : mesh.positions) p.z() = 1e-4 * (p.x() * p.x() + p.y() * p.y());
  const Positions u = applied(mesh, OperatorKind::umbrella);
  for (const OperatorKind kind : {OperatorKind::scale_dependent, OperatorKind::curvature}) {
    OperatorSource source(kind, false);
    const double unit = source.on(mesh, {}).unit;
    const Positions y = applied(mesh, kind);
    for (int r = 3; r < 10; ++r)
      for (int c = 3; c < 10; ++c) {
        const std::size_t i = std::size_t(r) * 13 + c;
        EXPECT_LT((unit * y[i] - 2 * u[i]).norm(), 0.02 * u[i].norm()) << int(kind);
      }
  }
}

TEST(ThinPlate, IsOfTheOperatorTwice) {
  Mesh mesh = support::torus(12, 9, 0.4);
  OperatorSource source(OperatorKind::scale_dependent, false);
  const Operator& op = source.on(mesh, {});
  Positions once, twice;
  apply(mesh.one_ring, op, mesh.positions, once, {});
  apply(mesh.one_ring, op, once, twice, {});
  EXPECT_NEAR(thin_plate_energy(mesh.one_ring, op, mesh.positions, {}), inner(op, mesh.positions, twice),
              1e-10 * inner(op, once, once));
}

/// Desbrun 5.5: towards the mean of the neighbours, weighted by their cotangents, the negative ones too.
TEST(Normalised, DividesByTheSumOfTheWeights) {
  Mesh mesh = support::torus(24, 12, 0.4);
  support::add_noise(mesh, 0.04, 5);  // obtuse enough for some negative weights
  const Operator plain = curvature(mesh, vertex_faces(mesh, {}), {});
  const Operator op = normalised(mesh.one_ring, plain, {});
  Positions L;
  apply(mesh.one_ring, op, mesh.positions, L, {});
  int negative = 0;
  for (Index i = 0; i < mesh.positions.size(); ++i) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double sum = 0;
    bool any = false;
    for (Index k = mesh.one_ring.start[i]; k < mesh.one_ring.start[i + 1]; ++k) {
      mean += plain.weight[k] * mesh.positions[mesh.one_ring.items[k]];
      sum += plain.weight[k];
      any = any || plain.weight[k] < 0;
    }
    if (!(sum > 0.1)) continue;
    EXPECT_LT((mesh.positions[i] - mean / sum - L[i]).norm(), 1e-12);
    negative += any ? 1 : 0;
  }
  EXPECT_GT(negative, 0);
}

}  // namespace
