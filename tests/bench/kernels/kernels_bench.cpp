// Our own small kernels beside Eigen's, one pair of rows each (../README.md has the ratios):
//   factors and solves of the least-squares systems     SmallCholesky | Eigen::LLT
//   normal of the plane through 12 neighbours           plane_normal  | Eigen::SelfAdjointEigenSolver,
//   iterative and direct implicit fairing, first order, umbrella, dt = 10     solve()       |
//   Eigen::ConjugateGradient, one thread each
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/Sparse>
#include <benchmark/benchmark.h>

#include "base/linear/small_cholesky.h"
#include "rfs_mesh/fit/plane_normal.h"
#include "smoothing/integrators/solver.h"
#include "smoothing/operators/operator.h"
#include "tests/support/meshes.h"

namespace {

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

constexpr std::size_t kProblems = 1024;

template <int N>
using Square = Eigen::Matrix<double, N, N>;

/// A A^T + 1 of normal A, as a least-squares fit gives.
template <int N>
std::vector<Square<N>> systems() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Square<N>> all(kProblems);
  for (auto& system : all) {
    const Square<N> a = Square<N>::NullaryExpr([&] { return normal(random); });
    system = a * a.transpose() + Square<N>::Identity();
  }
  return all;
}

template <int N, class Factors>
void solves(benchmark::State& state) {
  const auto all = systems<N>();
  const Eigen::Matrix<double, N, 1> right = Eigen::Matrix<double, N, 1>::Ones();
  for (auto _ : state)
    for (const auto& system : all) {
      const Eigen::Matrix<double, N, 1> x = Factors(system).solve(right);
      benchmark::DoNotOptimize(x.data());
      benchmark::ClobberMemory();
    }
}
BENCHMARK_TEMPLATE(solves, 5, SmallCholesky<5>);
BENCHMARK_TEMPLATE(solves, 5, Eigen::LLT<Square<5>>);
BENCHMARK_TEMPLATE(solves, 6, SmallCholesky<6>);
BENCHMARK_TEMPLATE(solves, 6, Eigen::LLT<Square<6>>);
BENCHMARK_TEMPLATE(solves, 9, SmallCholesky<9>);
BENCHMARK_TEMPLATE(solves, 9, Eigen::LLT<Square<9>>);

void inverses_small_cholesky(benchmark::State& state) {
  const auto all = systems<6>();
  for (auto _ : state)
    for (const auto& system : all) {
      const Square<6> inverse = SmallCholesky<6>(system).inverse();
      benchmark::DoNotOptimize(inverse.data());
      benchmark::ClobberMemory();
    }
}
BENCHMARK(inverses_small_cholesky);

void inverses_eigen(benchmark::State& state) {
  const auto all = systems<6>();
  for (auto _ : state)
    for (const auto& system : all) {
      const Square<6> inverse = Eigen::LLT<Square<6>>(system).solve(Square<6>::Identity());
      benchmark::DoNotOptimize(inverse.data());
      benchmark::ClobberMemory();
    }
}
BENCHMARK(inverses_eigen);

constexpr std::size_t kNear = 12;

/// Points in a disk with a little noise, and the row 1 .. kNear.
struct Disk {
  Positions points;
  std::vector<Index> near;
  Disk() {
    std::mt19937 random(2);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i <= kNear; ++i) {
      points.emplace_back(normal(random), normal(random), 0.1 * normal(random));
      if (i > 0) near.push_back(Index(i));
    }
  }
};

Eigen::Matrix3d covariance(const Disk& disk) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : disk.points) mean += p;
  mean /= double(disk.points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& p : disk.points) spread += (p - mean) * (p - mean).transpose();
  return spread;
}

void normal_ours(benchmark::State& state) {
  const Disk disk;
  for (auto _ : state)
    benchmark::DoNotOptimize(
        rfs_mesh::plane_normal(disk.points, 0, {disk.near.data(), disk.near.data() + disk.near.size()}));
}
BENCHMARK(normal_ours);

void normal_eigen(benchmark::State& state) {
  const Disk disk;
  for (auto _ : state) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance(disk));
    benchmark::DoNotOptimize(solver.eigenvectors().data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(normal_eigen);

void normal_eigen_direct(benchmark::State& state) {
  const Disk disk;
  for (auto _ : state) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(covariance(disk));
    benchmark::DoNotOptimize(solver.eigenvectors().data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(normal_eigen_direct);

constexpr double kTimeStep = 10, kTolerance = 1e-5;

Mesh rough_torus() {
  Mesh mesh = support::torus(500, 290, 0.4);
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1e-3);
  for (auto& p : mesh.positions) p += Eigen::Vector3d::NullaryExpr([&] { return normal(random); });
  return mesh;
}

void fairing_ours(benchmark::State& state) {
  const Mesh mesh = rough_torus();
  Context context;
  context.threads = 1;
  const Operator op = umbrella(mesh.one_ring, context);
  Fairing system{mesh.one_ring, op};
  system.a[0] = kTimeStep;
  SolverOptions options;
  options.tolerance = kTolerance;
  for (auto _ : state) {
    Positions x;
    state.counters["iterations"] = solve(system, mesh.positions, x, {}, options, context).iterations;
  }
}
BENCHMARK(fairing_ours)->Unit(benchmark::kMillisecond);

/// (D + dt (D - W)) x = D o; the matrix is given, only the solve counts.
void fairing_eigen(benchmark::State& state) {
  const Mesh mesh = rough_torus();
  const auto n = Eigen::Index(mesh.positions.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d right(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    double degree = 0;
    for (const auto j : mesh.one_ring[std::size_t(i)]) {
      entries.emplace_back(i, j, -kTimeStep);
      ++degree;
    }
    entries.emplace_back(i, i, (1 + kTimeStep) * degree);
    right.row(i) = degree * mesh.positions[std::size_t(i)];
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  for (auto _ : state) {
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double, Eigen::RowMajor>, Eigen::Lower | Eigen::Upper>
        solver;
    solver.setTolerance(kTolerance);
    solver.compute(matrix);
    const Eigen::MatrixX3d x = solver.solve(right);
    benchmark::DoNotOptimize(x.data());
    state.counters["iterations"] = double(solver.iterations());
  }
}
BENCHMARK(fairing_eigen)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
