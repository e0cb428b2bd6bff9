#include "smoothing/integrators/solver.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

struct Dense {
  MatrixXd S, M;
};

Dense dense(const Mesh& mesh, const Operator& op) {
  const auto n = Eigen::Index(mesh.positions.size());
  Dense d{MatrixXd::Zero(n, n), MatrixXd::Zero(n, n)};
  for (Index i = 0; i < n; ++i) {
    d.M(i, i) = op.mass[i];
    for (Index k = mesh.one_ring.start[i]; k < mesh.one_ring.start[i + 1]; ++k) {
      const double w = op.weight.empty() ? 1 : op.weight[k];
      d.S(i, i) += w;
      d.S(i, mesh.one_ring.items[k]) -= w;
    }
  }
  return d;
}

MatrixXd rows_of(const Positions& x) {
  MatrixXd m(Eigen::Index(x.size()), 3);
  for (std::size_t i = 0; i < x.size(); ++i) m.row(Eigen::Index(i)) = x[i];
  return m;
}

MatrixXd diagonal(const std::vector<double>& d) {
  return Eigen::Map<const Eigen::VectorXd>(d.data(), Eigen::Index(d.size())).asDiagonal();
}

TEST(Solver, ImplicitFairingByDefaultTakesThePolynomial) {
  Mesh mesh = support::icosphere(4);
  support::add_noise(mesh, 0.02, 1);
  const ImplicitOptions options;
  const Operator op = umbrella(mesh.one_ring, {});
  SolverOptions how;
  how.tolerance = options.tolerance;
  Positions x;
  const SolverReport report =
      solve({mesh.one_ring, op, {0, options.dt, 0, 0}, {}, {}}, mesh.positions, x, {}, how, {});
  ASSERT_TRUE(report.by_polynomials);
  Constraints even;
  even.strength.assign(mesh.positions.size(), 1);
  for (const bool constrained : {false, true}) {
    Mesh stepped = mesh;
    const auto flow = options.start(stepped, constrained ? even : Constraints(), {});
    flow->step(stepped, {});
    EXPECT_TRUE(stepped.positions == x) << constrained;
  }
}

TEST(Solver, EqualsADenseFactorisationForEveryTerm) {
  Mesh mesh = support::torus(12, 8, 0.4);
  support::add_noise(mesh, 0.05, 1);
  for (const OperatorKind kind :
       {OperatorKind::umbrella, OperatorKind::scale_dependent, OperatorKind::curvature}) {
    OperatorSource source(kind, false);
    const Operator& op = source.on(mesh, {});
    const Dense d = dense(mesh, op);
    const MatrixXd L = d.M.inverse() * d.S;
    for (int order = 1; order <= 4; ++order) {
      Fairing system{mesh.one_ring, op};
      system.a[0] = 0.3 * op.unit;
      system.a[std::size_t(order) - 1] += 5 * std::pow(op.unit, order);
      MatrixXd A = d.M, power = MatrixXd::Identity(d.M.rows(), d.M.rows());
      for (int k = 0; k < order; ++k) {
        power = power * L;
        A += system.a[std::size_t(k)] * d.M * power;
      }
      const MatrixXd expected = A.ldlt().solve(d.M * rows_of(mesh.positions));
      Positions x;
      SolverOptions options;
      options.tolerance = 1e-13;
      const SolverReport report = solve(system, mesh.positions, x, {}, options, {});
      EXPECT_TRUE(report.converged) << int(kind) << order;
      EXPECT_LT((rows_of(x) - expected).norm(), 1e-9 * expected.norm()) << int(kind) << order;
    }
  }
}

TEST(Solver, EdgeWeightsDataAndStrengthPerVertexEnterAsWritten) {
  Mesh mesh = support::icosphere(2);
  support::add_noise(mesh, 0.05, 1);
  Operator op = inverse_distance(mesh, {});
  const std::size_t n = mesh.positions.size();
  Fairing system{mesh.one_ring, op};
  system.a = {0.5, 7, 0, 0};
  for (std::size_t i = 0; i < n; ++i) {
    system.data.push_back(i % 3 == 0 ? 0 : op.mass[i] * (1 + 0.1 * double(i % 5)));
    system.strength.push_back(double(i % 7));
  }
  const Dense d = dense(mesh, op);
  const MatrixXd Q = diagonal(system.data), C = diagonal(system.strength);
  const MatrixXd A = Q + 0.5 * d.S + 7 * d.S * C * d.M.inverse() * d.S;
  const MatrixXd expected = A.ldlt().solve(Q * rows_of(mesh.positions));
  Positions x;
  SolverOptions options;
  options.tolerance = 1e-13;
  EXPECT_TRUE(solve(system, mesh.positions, x, {}, options, {}).converged);
  EXPECT_LT((rows_of(x) - expected).norm(), 1e-9 * expected.norm());
}

TEST(Solver, HardConstraintsAreKeptAndTheRestIsOptimal) {
  Mesh mesh = support::icosphere(2);
  support::add_noise(mesh, 0.05, 1);
  const Operator op = umbrella(mesh.one_ring, {});
  Fairing system{mesh.one_ring, op};
  system.a = {0, 10, 0, 0};
  const Vector3d direction(1, 2, 2);
  const Constraints constraints{{{3, HardConstraint::Kind::fixed, Vector3d::Zero()},
                                 {7, HardConstraint::Kind::axis, direction},
                                 {9, HardConstraint::Kind::plane, direction}},
                                {}};
  const AllowedMoves allowed(constraints, mesh.positions.size());
  Positions x;
  SolverOptions options;
  options.tolerance = 1e-12;
  ASSERT_TRUE(solve(system, mesh.positions, x, allowed, options, {}).converged);
  EXPECT_EQ(x[3], mesh.positions[3]);
  EXPECT_LT((x[7] - mesh.positions[7]).cross(direction).norm(), 1e-14);
  EXPECT_LT(std::abs((x[9] - mesh.positions[9]).dot(direction)), 1e-14);
  const Dense d = dense(mesh, op);
  const MatrixXd A = d.M + 10 * d.S * d.M.inverse() * d.S;
  const MatrixXd gradient = A * rows_of(x) - d.M * rows_of(mesh.positions);
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_LT(allowed(i, Vector3d(gradient.row(Eigen::Index(i)))).norm(), 1e-9);
}

TEST(Solver, WarmStartFromTheSolutionNeedsNoIteration) {
  Mesh mesh = support::icosphere(3);
  support::add_noise(mesh, 0.05, 1);
  const Operator op = umbrella(mesh.one_ring, {});
  Fairing system{mesh.one_ring, op};
  system.a = {0, 100, 0, 0};
  Positions x;
  SolverOptions options;
  options.tolerance = 1e-6;
  EXPECT_GT(solve(system, mesh.positions, x, {}, options, {}).iterations, 5);
  options.tolerance = 2e-6;
  EXPECT_EQ(solve(system, mesh.positions, x, {}, options, {}).iterations, 0);
  // Solved to rounding, it is solved as well relative to the start.
  options.tolerance = 1e-14;
  solve(system, mesh.positions, x, {}, options, {});
  options.tolerance = 1e-3;
  options.of_start = true;
  const SolverReport again = solve(system, mesh.positions, x, {}, options, {});
  EXPECT_EQ(again.iterations, 0);
  EXPECT_TRUE(again.converged);
}

TEST(Solver, RelativeToTheStartTheErrorIsReducedAsAskedForWhateverTheExtent) {
  Mesh mesh = support::icosphere(2);
  support::add_noise(mesh, 0.05, 1);
  const std::array<double, 4> a = {0, 100, 0, 0};
  const Operator op = umbrella(mesh.one_ring, {});
  const Dense d = dense(mesh, op);
  const MatrixXd start = rows_of(mesh.positions), A = d.M + a[1] * d.S * d.M.inverse() * d.S,
                 exact = A.ldlt().solve(d.M * start), masses = d.M.cwiseSqrt();
  Mesh apart = mesh;  // and itself far away
  for (const Face& face : mesh.faces) {
    Face other = face;
    for (Index& corner : other) corner += Index(mesh.positions.size());
    apart.faces.push_back(other);
  }
  for (const Vector3d& p : mesh.positions) apart.positions.emplace_back(p + Vector3d(1000, 0, 0));
  rebuild_adjacency(apart, {});
  const Operator op_apart = umbrella(apart.one_ring, {});
  for (const double tolerance : {0.1, 1e-3}) {
    SolverOptions options;
    options.tolerance = tolerance;
    options.of_start = true;
    Positions x, y;
    const SolverReport report = solve({mesh.one_ring, op, a, {}, {}}, mesh.positions, x, {}, options, {});
    EXPECT_TRUE(report.converged && report.by_polynomials);
    EXPECT_LT((masses * (rows_of(x) - exact)).norm(), tolerance * (masses * (start - exact)).norm());
    EXPECT_EQ(solve({apart.one_ring, op_apart, a, {}, {}}, apart.positions, y, {}, options, {}).iterations,
              report.iterations);
  }
}

TEST(Solver, SameBitsForAnyNumberOfThreadsAndAnyOriginOfTheStoppingTest) {
  Mesh mesh = support::icosphere(5);
  support::add_noise(mesh, 0.01, 1);
  const Operator op = umbrella(mesh.one_ring, {});
  Fairing system{mesh.one_ring, op};
  system.a = {10, 0, 0, 0};
  Positions one, four, far;
  Context context;
  SolverReport here, there;
  context.threads = 1;
  in_arena(context, [&] { here = solve(system, mesh.positions, one, {}, {}, context); });
  context.threads = 4;
  in_arena(context, [&] { solve(system, mesh.positions, four, {}, {}, context); });
  EXPECT_EQ(one, four);
  for (Vector3d& p : mesh.positions) p += Vector3d(1000, 0, 0);
  there = solve(system, mesh.positions, far, {}, {}, {});
  EXPECT_EQ(here.iterations, there.iterations);
}

TEST(Solver, AnIndefiniteSystemStopsFiniteAndSaysSo) {
  Mesh mesh = support::icosphere(2);
  support::add_noise(mesh, 0.05, 1);
  const Operator op = umbrella(mesh.one_ring, {});
  Fairing system{mesh.one_ring, op};
  system.a = {-3, 0, 0, 0};
  Positions x;
  const SolverReport report = solve(system, mesh.positions, x, {}, {}, {});
  EXPECT_FALSE(report.converged);
  for (const Vector3d& p : x) EXPECT_TRUE(p.allFinite());
}

TEST(Solver, ArraysOfTheWrongSizeThrow) {
  const Mesh mesh = support::icosphere(1);
  const Operator op = umbrella(mesh.one_ring, {});
  Fairing system{mesh.one_ring, op};
  system.strength = {1, 2};
  Positions x;
  EXPECT_THROW(solve(system, mesh.positions, x, {}, {}, {}), std::invalid_argument);
}

}  // namespace
